// Mutant layer of scripts/mutation_test.py. scripts/mutants.py writes calls of it into a copy of the sources:
// `a + b` becomes `mutation::Plus(17, a, b)`, which is `a - b` while `active` is 17.
// tests/mutation/mutant_tests.cc sets `active`, reads and clears `reached`.
#pragma once

namespace mutation {

inline constexpr int kMaxMutants = 20000;

inline int active = -1;
inline bool reached[kMaxMutants] = {};

inline bool Active(int id) {
  if (!reached[id]) reached[id] = true;
  return id == active;
}

// Both sides are evaluated once, in every case.
#define SONARCAL_MUTATION_PAIR(name, op, mutated)                      \
  template <typename A, typename B>                                    \
  auto name(int id, const A& a, const B& b)->decltype(a op b) {        \
    if (Active(id)) return static_cast<decltype(a op b)>(a mutated b); \
    return a op b;                                                     \
  }
SONARCAL_MUTATION_PAIR(Plus, +, -)
SONARCAL_MUTATION_PAIR(Minus, -, +)
SONARCAL_MUTATION_PAIR(Times, *, /)
SONARCAL_MUTATION_PAIR(Over, /, *)
SONARCAL_MUTATION_PAIR(Less, <, <=)
SONARCAL_MUTATION_PAIR(LessEqual, <=, <)
SONARCAL_MUTATION_PAIR(Greater, >, >=)
SONARCAL_MUTATION_PAIR(GreaterEqual, >=, >)
SONARCAL_MUTATION_PAIR(Equal, ==, !=)
SONARCAL_MUTATION_PAIR(NotEqual, !=, ==)
#undef SONARCAL_MUTATION_PAIR

#define SONARCAL_MUTATION_ASSIGN(name, op, mutated) \
  template <typename A, typename B>                 \
  A& name(int id, A& a, const B& b) {               \
    if (Active(id)) return a mutated b;             \
    return a op b;                                  \
  }
SONARCAL_MUTATION_ASSIGN(AddTo, +=, -=)
SONARCAL_MUTATION_ASSIGN(TakeFrom, -=, +=)
SONARCAL_MUTATION_ASSIGN(Scale, *=, /=)
SONARCAL_MUTATION_ASSIGN(Divide, /=, *=)
#undef SONARCAL_MUTATION_ASSIGN

// 0 becomes 1, another number twice its value.
template <typename T>
T Number(int id, T value) {
  if (!Active(id)) return value;
  return value == T(0) ? T(1) : static_cast<T>(value + value);
}

template <typename T>
auto Negative(int id, const T& value) -> decltype(-value) {
  if (Active(id)) return +value;
  return -value;
}

inline bool Not(int id, bool value) {
  return Active(id) ? value : !value;
}

inline bool Result(int id, bool value) {
  return Active(id) ? !value : value;
}

}  // namespace mutation
