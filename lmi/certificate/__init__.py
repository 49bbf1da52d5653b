"""What is trusted: exact certificates, read, decided in integers and printed, on the standard library alone."""

from lmi.certificate.sandwich import Bounds, Certificate, Check, ExactPlant, Interval, exact_plant, verify

__all__ = ["Bounds", "Certificate", "Check", "ExactPlant", "Interval", "exact_plant", "verify"]
