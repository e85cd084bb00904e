#include "doublet/fit/parts/even_points.h"

namespace doublet {
namespace {

/// Van der Corput's sequence: the digits of `i` in `base`, mirrored at the point; in (0, 1) for i > 0.
double radical_inverse(int i, int base) {
  double value = 0, digit = 1;
  for (; i > 0; i /= base) {
    digit /= base;
    value += digit * (i % base);
  }
  return value;
}

int next_prime(int number) {
  for (bool prime = false; !prime;) {
    ++number;
    prime = true;
    for (int d = 2; d * d <= number; ++d)
      prime = prime && number % d != 0;
  }
  return number;
}

} // namespace

MatrixRM even_points(int count, int n, int first) {
  MatrixRM points(count, n);
  int prime = 1;
  for (int j = 0; j < n; ++j) {
    prime = next_prime(prime);
    for (int i = 0; i < count; ++i)
      points(i, j) = radical_inverse(first + i + 1, prime);
  }
  return points;
}

} // namespace doublet
