"""What every versioned file and record stands on: reading small texts, JSON, and refusals in one sentence."""
