// What A. Brown's thesis found: tables 5.1 (before a tolerance was exceeded) and 5.2 (after).
#pragma once

#include <array>
#include <string_view>

namespace aurasim::lab {

struct ThesisRow {
  std::string_view series;  ///< as name_of(Series)
  int trials;               ///< without those that thrashed
  double late_percent;
  double missed_percent;
  int thrashed;
};

inline constexpr std::array<ThesisRow, 9> kThesisWithin = {{{"speed_16m_s", 800, 1, 0.13, 0},
                                                            {"speed_32m_s", 1600, 0.688, 0.0422, 0},
                                                            {"speed_48m_s", 2372, 0.632, 0, 28},
                                                            {"latency_2ms", 1920, 10.7, 0, 7},
                                                            {"latency_8ms", 1520, 0, 0, 30},
                                                            {"latency_16ms", 797, 2.50, 0, 53},
                                                            {"frame_8.33ms", 450, 0, 0, 0},
                                                            {"frame_15ms", 800, 1.88, 0, 0},
                                                            {"frame_33.33ms", 251, 0, 0, 523}}};

inline constexpr std::array<ThesisRow, 9> kThesisBeyond = {{{"speed_16m_s", 800, 49.9, 0, 0},
                                                            {"speed_32m_s", 1589, 48.6, 0, 11},
                                                            {"speed_48m_s", 2233, 45.10, 1.12, 167},
                                                            {"latency_2ms", 1880, 13.99, 0, 0},
                                                            {"latency_8ms", 1377, 0.15, 0, 121},
                                                            {"latency_16ms", 574, 12.20, 0, 226},
                                                            {"frame_8.33ms", 400, 9.50, 0, 0},
                                                            {"frame_15ms", 750, 58.13, 0, 0},
                                                            {"frame_33.33ms", 106, 1.89, 0, 693}}};

inline constexpr double kThesisWorstBeyondSpeed = 49.9;
inline constexpr double kThesisWorstBeyondFrame = 58.13;

/// Late collisions at 15% packet loss, percent (section 5.2.5).
inline constexpr double kThesisLateAtFifteenPercentLoss = 50;

}  // namespace aurasim::lab
