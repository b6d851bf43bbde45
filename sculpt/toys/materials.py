"""Densities of toys, as mass per volume of their visual meshes, in [kg/m³]."""

WOOD = 620.0
"""Paper birch at 12 % moisture: specific gravity 0.55, and the water (USDA Wood Handbook 2010, table 5-3b)."""
POLYPROPYLENE = 905.0
"""Solid, such as the wall of a cup: 900 to 910 in data sheets by ISO 1183."""
TENNIS_BALL = 365.0
"""Hollow rubber and its air: 57.7 g in 6.7 cm (ITF Rules of Tennis: 56.0 to 59.4 g, 6.54 to 6.86 cm)."""
SHELL = 250.0
"""Hollow and moulded. An estimate: 1.5 mm of ABS (1,050) around a body of 2 cm half thickness is 0.2 of its volume."""
THIN_SHELL = 140.0
"""Hollow and blown, as play food and bath toys. An estimate: 1 mm of soft PVC (1,200) around a ball of 5 cm is 0.12."""
PLUSH = 150.0
"""An estimate: 0.3 kg/m² of pile fabric around a ball of 4 cm is 45, its filling 30, and beads weigh it down."""
FELT = 250.0
"""Pressed wool felt, of medium density: SAE grades run from 180 to 340."""
