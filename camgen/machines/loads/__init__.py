"""What every machine bears: masses of its solids, its drive, contacts, bearings and pins."""
