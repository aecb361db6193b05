"""The shipped missions: tutorials t01, t02, … and real ones."""
