"""Motor milestones: from which age on an infant can do what real infants learn to do."""
