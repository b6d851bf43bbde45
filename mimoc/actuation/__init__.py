"""What moves an infant's joints."""
