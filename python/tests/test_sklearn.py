import numpy as np
import pytest
from sklearn.base import clone
from sklearn.datasets import load_iris
from sklearn.model_selection import cross_val_score
from sklearn.utils.estimator_checks import parametrize_with_checks

from gonogo.sklearn import RbmClassifier


# scikit-learn's own suite, without exceptions.
@parametrize_with_checks([RbmClassifier(epochs=60)])
def test_conformance(estimator, check):
    check(estimator)


def test_iris_is_learned():
    rows, classes = load_iris(return_X_y=True)
    scores = cross_val_score(RbmClassifier(epochs=100, random_state=1), rows, classes, cv=5)
    assert scores.mean() > 0.9


def test_unknown_features_are_summed_out():
    rows, classes = load_iris(return_X_y=True)
    fitted = clone(RbmClassifier(epochs=100, random_state=1)).fit(rows, classes)
    hidden = rows.copy()
    hidden[:, 0] = np.nan
    p = fitted.predict_proba(hidden)
    assert p.sum(axis=1) == pytest.approx(1)
    assert fitted.score(hidden, classes) > 0.9
    assert np.array_equal(RbmClassifier(epochs=100, random_state=1).fit(rows, classes).predict_proba(rows), fitted.predict_proba(rows))
