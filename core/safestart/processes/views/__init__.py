"""The views of a process: ``kinds`` declares them, ``fitting`` checks them against the outputs they show."""

from safestart.processes.views.kinds import Column as Column
from safestart.processes.views.kinds import Comparison as Comparison
from safestart.processes.views.kinds import Facts as Facts
from safestart.processes.views.kinds import Findings as Findings
from safestart.processes.views.kinds import Flights as Flights
from safestart.processes.views.kinds import Layer as Layer
from safestart.processes.views.kinds import Matrices as Matrices
from safestart.processes.views.kinds import Overlay as Overlay
from safestart.processes.views.kinds import Picture as Picture
from safestart.processes.views.kinds import Rows as Rows
from safestart.processes.views.kinds import Scene as Scene
from safestart.processes.views.kinds import View as View
from safestart.processes.views.kinds import documents as documents
from safestart.processes.views.kinds import kinds as kinds
