"""How alike two texture pictures are."""

from voldetail.metric.descriptor import METRICS, Descriptor, describe, distance, distance_by_level, metric_named

__all__ = ["METRICS", "Descriptor", "describe", "distance", "distance_by_level", "metric_named"]
