"""What an infant touches."""

from mimoc.quantities.quantity import Quantity

CONTACTS_SELF = Quantity(
    "contacts_self",
    "Contacts with the own body",
    about="mean number of contacts between parts of the own body",
    read="mimoc.quantities.run_contact",
    steps=("run",),
)
