"""From objectives and bounds to a gain, what it achieves, and the proof."""
