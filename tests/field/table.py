# SPDX-License-Identifier: BSD-3-Clause
"""A line of what was measured."""


class Row:
    """What was measured, what is wanted, and whether it is so (None: nothing is wanted)."""

    def __init__(self, name, what, measured, wanted="", met=None):
        self.name, self.what, self.measured, self.wanted, self.met = name, what, str(measured), str(wanted), met

    def verdict(self):
        return {None: "", True: "met", False: "**MISSED**"}[self.met]
