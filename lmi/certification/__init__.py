"""Makers of exact certificates; nothing here needs trust, as what they make is verified by `lmi.certificate`."""
