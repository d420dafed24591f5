"""From bytes to what the receiver said: ``framing`` cuts lines, ``nmea`` reads them, ``decoder`` joins an epoch."""
