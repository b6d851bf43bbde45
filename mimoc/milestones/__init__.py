"""Motor milestones: at what age an infant can do what real infants can."""
