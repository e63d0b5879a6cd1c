"""Campaigns: draw cases, cut them into shards, simulate, tally, keep the worst, record, merge.

A sweep or a Monte Carlo consists of four parts in a :class:`~safestart.campaign.study.Study`:

- its **design** (``design.py``): the numbered cases and the parameters of each;
- its **columns** (``table.py``): the typed outcome of one case;
- its **tally** (``tally.py`` and the files of its kinds: ``rates.py``, ``spread.py``, ``kept.py``, ``combined.py``):
  the counts over all cases, and the rows to keep;
- ``simulate``: one :class:`~safestart.campaign.case.Case` in, one outcome out.

Every random draw belongs to a case or to a block of cases (``case.py``), so the result is the same for any number
of workers and any order of the shards. Apart from the records, only one shard's rows are in memory at a time.
"""
