# SPDX-License-Identifier: Apache-2.0
"""Reads a report as a person does, in headless Chromium: hovers, clicks, wipes, types, and holds what the page shows against the
EXR files and numbers of its run.

Usage: test_in_browser.py VECINO SOURCE_DIR [TEST...]. Exits with 125, skipped, where there is no Chromium that works.
"""

import sys
import unittest

import report_reader
from browser import NoBrowser


def main(program, source, *names):
    try:
        page = report_reader.start(program, source)
    except NoBrowser as reason:
        print(f"skipped: {reason}")
        return 125
    with page:
        print(f"driving {page.version}", flush=True)
        import test_page
        import test_viewer

        loader, modules = unittest.TestLoader(), (test_viewer, test_page)
        loader.testNamePatterns = [f"*{name}*" for name in names] or None
        suite = unittest.TestSuite(loader.loadTestsFromModule(module) for module in modules)
        result = unittest.TextTestRunner(verbosity=2).run(suite)
    return 0 if result.wasSuccessful() and result.testsRun > 0 else 1


sys.exit(main(*sys.argv[1:]))
