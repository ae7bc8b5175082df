"""voldetail: relief from one photograph, as a small procedural detail that renders on any mesh under any light."""

from voldetail import backend

__version__ = "0.1.0"

backend.prepare()
