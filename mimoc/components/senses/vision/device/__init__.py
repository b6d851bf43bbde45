"""Vision on a device: both eyes of all infants by MuJoCo Warp's ray caster, then acuity, foveation and delay."""
