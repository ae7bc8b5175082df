"""Where a fit may start: reliefs rendered beforehand, whose pictures are compared with the photo's in a moment."""

from voldetail.fit.warmstart.choose import starts_from
from voldetail.fit.warmstart.source import ELEVATIONS, ENTRIES, ReliefSource

__all__ = ["ELEVATIONS", "ENTRIES", "ReliefSource", "starts_from"]
