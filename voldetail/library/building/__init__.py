"""How libraries are made: sources, plans, workers, staging and finishing."""
