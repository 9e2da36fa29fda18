"""What the scripts that check reports have in common: a line for each check, and the account of those that fail."""

import sys

faults = []


def check(holds, text):
    """Prints one line of the table and remembers what does not hold."""
    print(f"  {'ok   ' if holds else 'FAULT'}  {text}")
    if not holds:
        faults.append(text)


def status():
    """Names the faults; the exit status."""
    for fault in faults:
        print(f"error: {fault}", file=sys.stderr)
    return 1 if faults else 0
