"""Holding of postures by a saturating controller, within an infant's own strength."""
