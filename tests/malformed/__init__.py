# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""A corpus of damaged files of every format, made by rule and sorted by rule: see write.py and ../malformed_corpus_test.py."""
