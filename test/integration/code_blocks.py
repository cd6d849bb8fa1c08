"""Blocks of code in a text: each runs, and each value in a comment is the value of its line."""

import ast
import re
import unittest

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
VALUE = re.compile(r"#\s+(-?\d[\d.]*(?:e-?\d+)?|True|False|\(\d[\d, ]*\))(?:$|[ ,:])")


class CodeTest(unittest.TestCase):
    checked = 0  # values

    def run_block(self, text, session):
        lines = text.splitlines()
        for statement in ast.parse(text).body:
            with self.subTest(line=lines[statement.lineno - 1]):
                if not isinstance(statement, ast.Expr):
                    exec(compile(ast.Module([statement], []), "text", "exec"), session)
                    continue
                value = eval(compile(ast.Expression(statement.value), "text", "eval"), session)
                stated = VALUE.search(lines[statement.end_lineno - 1])
                if stated:
                    self.compare(value, stated[1])

    def compare(self, value, stated):
        self.checked += 1
        if re.match(r"[TF(]", stated):
            self.assertEqual(value, ast.literal_eval(stated))
        else:
            decimals = len(stated.partition(".")[2])
            self.assertLessEqual(abs(value - float(stated)), 0.5000001 * 10.0**-decimals, stated)
