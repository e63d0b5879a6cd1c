"""Campaigns: draw cases, cut them into shards, simulate, tally, keep the worst, record, merge.

A sweep or a Monte Carlo says four things in a :class:`~safestart.campaign.study.Study` and is done:

- its **design** (``design.py``): the numbered cases and the parameters of each;
- its **columns** (``table.py``): the typed outcome of one case;
- its **tally** (``tally.py`` and the files of its kinds: ``rates.py``, ``spread.py``, ``kept.py``, ``combined.py``):
  what is counted over all cases, and which rows are kept;
- ``simulate``: one :class:`~safestart.campaign.case.Case` in, one outcome out.

Whatever is random belongs to the case or to a block of cases (``case.py``), so the result is the same for any number
of workers and any order of the shards. No more than one shard's rows are in memory at a time, its records aside.
"""
