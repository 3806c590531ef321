"""Our learner as a scikit-learn classifier, for comparisons on any table."""
from typing import Any

import numpy as np
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils import check_random_state
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_is_fitted, validate_data

from . import _core
from ._training import _with_torch


class RbmClassifier(ClassifierMixin, BaseEstimator):
    """A restricted Boltzmann machine for P(class | features), with NaN for unknown features.

    Every feature is encoded in `bins` bins of equally many rows: "thermometer", "one_hot", "gray" or "binary". fit() needs
    a build with LibTorch; predict_proba() does not. The same rows, parameters and random_state give the same bits.
    """

    def __init__(self, hidden: int = 8, *, bins: int = 8, code: str = "thermometer", epochs: int = 100,
                 learning_rate: float = 0.02, weight_decay: float = 1.0, generative: float = 0.05,
                 random_state: Any = None) -> None:
        self.hidden = hidden
        self.bins = bins
        self.code = code
        self.epochs = epochs
        self.learning_rate = learning_rate
        self.weight_decay = weight_decay
        self.generative = generative
        self.random_state = random_state

    def fit(self, X: Any, y: Any) -> "RbmClassifier":
        """Trains on rows X [row, feature] of the classes y [row]."""
        X, y = validate_data(self, X, y, dtype=np.float64, ensure_all_finite="allow-nan", order="C")
        check_classification_targets(y)
        self.classes_, outcome = np.unique(y, return_inverse=True)
        if len(self.classes_) < 2:
            raise ValueError(f"RbmClassifier needs at least 2 classes; y has 1 class, {self.classes_[0]!r}")
        seed = int(check_random_state(self.random_state).randint(2**31))
        names = [str(k) for k in range(len(self.classes_))]
        self.layout_, self.weight_, self.visible_bias_, self.hidden_bias_ = _with_torch().fit(
            np.ascontiguousarray(X), np.ascontiguousarray(outcome, dtype=np.int64), np.ones(len(X)), names, self.bins, self.code,
            self.hidden, self.epochs, self.learning_rate, self.weight_decay, self.generative, seed)
        return self

    def predict_proba(self, X: Any) -> Any:
        """P(class) [row, class], in the order of classes_."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=np.float64, ensure_all_finite="allow-nan", order="C", reset=False)
        machine = _core.Machine(self.layout_, self.weight_, self.visible_bias_, self.hidden_bias_)
        return machine.probabilities(np.ascontiguousarray(X))

    def predict(self, X: Any) -> Any:
        """The most probable class of every row."""
        p = self.predict_proba(X)
        return self.classes_[p.argmax(axis=1)]

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.allow_nan = True
        return tags
