#!/usr/bin/python3
"""The lower bound of a tuned figure against the figure at many points."""

import unittest

import numpy as np
import stochastic_platoon as sp
from stochastic_platoon import bounds

PAPER_BOX = {"controller/numerator/0": [0.1, 4.0], "controller/denominator/1": [-0.95, 0.95]}
FIGURES = ("limit_variance", "peak_gain", "sensitivity_peak")


class LowerBound(unittest.TestCase):
    def bound_of(self, model, figure, box, goal, optimum):
        return bounds.lower_bound(model, figure, box, goal, optimum, 60.0, lambda boxes, least: None)

    def test_of_the_limit_variance_is_below_it_and_close(self):
        result = sp.tune(sp.Model.load(), minimise="limit_variance", over=PAPER_BOX, subject_to={"string_stable": True}, realizations=0)
        self.assertLess(result.bound, result.goal)
        self.assertGreater(result.bound, 0.98 * result.goal)

    def test_respects_constraints_on_figures_that_have_a_bound(self):
        model, known = sp.Model.load(), dict(minimise="limit_variance", over=PAPER_BOX, realizations=0)
        free = sp.tune(model, **known, subject_to={"string_stable": True})
        result = sp.tune(model, **known, subject_to={"string_stable": True, "sensitivity_peak": 2.45})
        self.assertGreater(result.bound, free.goal)
        self.assertLess(result.bound, result.goal)
        self.assertGreater(result.bound, 0.98 * result.goal)
        self.assertNotIn("leaves out", result.report)
        # With a goal above the optimum the bound stays below the optimum, so that no feasible box is excluded.
        bound, _ = bounds.lower_bound(model, "limit_variance", PAPER_BOX, 1.05 * result.goal, list(result.variables.values()), 2.0,
                                      lambda boxes, least: None, {"sensitivity_peak": 2.45})
        self.assertLess(bound, result.goal)
        result = sp.tune(model, **known, subject_to={"string_stable": True, "spectral_radius": 0.9})
        self.assertLess(result.bound, result.goal)
        self.assertIn("leaves out the constraints on spectral_radius", result.report)

    def test_of_each_figure_is_below_it_at_every_stable_point_of_a_box(self):
        random = np.random.RandomState(3)
        boxes = (("paper.yaml", {"controller/numerator/0": (0.5, 2.0), "controller/denominator/1": (-0.5, 0.9)}, ("peak_gain", "sensitivity_peak")),
                 ("acc.yaml", {"controller/kp": (0.05, 0.5), "controller/kd": (0.3, 1.5)}, FIGURES),
                 ("paper.yaml", {"controller/numerator/0": (1.1, 1.5), "controller/denominator/1": (0.6, 0.95)}, FIGURES))  # more is string stable
        for file, whole, figures in boxes:
            model = sp.Model.load(file)
            for figure in figures:
                judged = 0
                for _ in range(10):
                    at = np.array([random.uniform(*ends) for ends in whole.values()])
                    size = 0.1 * random.uniform() * np.array([high - low for low, high in whole.values()])
                    integrand = bounds.Integrand(bounds.Loop(model, list(whole)), figure, at)
                    bound = integrand.bounds((at - size)[None, :], (at + size)[None, :])[0]
                    for corner in [at] + [at + size * random.uniform(-1, 1, 2) for _ in range(3)]:
                        try:
                            analysis = sp.analyze(model.replace(dict(zip(whole, corner))), followers=1, steps=1)
                        except ValueError:  # an unstable loop
                            continue
                        if analysis.string_stable or (figure != "limit_variance" and analysis[figure] is not None):
                            self.assertLessEqual(bound, analysis[figure] * (1.0 + 1e-9), (file, figure, corner))
                            judged += 1
                self.assertGreaterEqual(judged, 10, (file, figure))  # of 40 points

    def test_of_a_tiny_box_is_the_figure_itself(self):
        for file, box in (("paper.yaml", {"controller/numerator/0": 1.2, "controller/denominator/1": 0.7}),
                          ("acc.yaml", {"controller/kp": 0.2, "controller/kd": 0.7})):
            model, at = sp.Model.load(file).replace(box), np.array(list(box.values()))
            for figure in FIGURES:
                integrand = bounds.Integrand(bounds.Loop(model, list(box)), figure, at)
                bound = integrand.bounds((at - 1e-9)[None, :], (at + 1e-9)[None, :])[0]
                self.assertAlmostEqual(bound / sp.analyze(model)[figure], 1.0, delta=0.005, msg=(file, figure))

    def test_does_not_exist_where_it_is_not_proved(self):
        for file, figure, keys in (("cacc.yaml", "limit_variance", ["controller/kp"]), ("paper.yaml", "rounding", ["controller/numerator/0"]),
                                   ("paper.yaml", "limit_variance", ["time_headway"]), ("lossy.yaml", "limit_variance", ["controller/numerator/0"])):
            self.assertTrue(bounds.reason_without_bound(sp.Model.load(file), figure, keys), file)
        self.assertEqual(bounds.reason_without_bound(sp.Model.load(), "limit_variance", list(PAPER_BOX)), "")


if __name__ == "__main__":
    unittest.main()
