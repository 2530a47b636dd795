// Exchange and halo on any number of ranks.

#include <gtest/gtest.h>

#include "gather.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

/// Says where it comes from and where it goes to.
struct Letter {
  int from, to, number;
  double weight;
  friend bool operator==(const Letter&, const Letter&) = default;
};

/// Sends count(from, to) letters along the pairs of ranks and checks what arrives.
template <class Count>
void expect_delivery(Count&& count) {
  const int self = rank_of(comm);
  std::vector<std::pair<int, int>> runs;
  std::vector<Letter> send, expected;
  for (int to = ranks_of(comm) - 1; to >= 0; --to) {  // the order of the runs is free
    if (count(self, to) < 0) continue;                // no run at all
    runs.emplace_back(to, count(self, to));
    for (int k = 0; k < count(self, to); ++k) send.push_back({self, to, k, 0.1 * k});
  }
  for (int from = 0; from < ranks_of(comm); ++from)
    for (int k = 0; k < count(from, self); ++k) expected.push_back({from, self, k, 0.1 * k});
  const Exchange exchange(comm, runs);
  EXPECT_EQ(exchange.n_send(), static_cast<int>(send.size()));
  ASSERT_EQ(exchange.n_receive(), static_cast<int>(expected.size()));
  for (int repeat = 0; repeat < 2; ++repeat) {
    std::vector<Letter> received(expected.size());
    exchange.forward(send.data(), received.data());
    EXPECT_EQ(received, expected);
  }
}

TEST(Exchange, DeliversRunsOfAnyLengthInTheOrderOfTheSenders) {
  expect_delivery([](int from, int to) { return (3 * from + 2 * to + 1) % 5; });
}

TEST(Exchange, DeliversEmptyRuns) {
  expect_delivery([](int from, int to) { return (from + to) % 2 == 0 ? 0 : 3; });
  expect_delivery([](int, int) { return 0; });
}

TEST(Exchange, NeedsNoRuns) {
  expect_delivery([](int, int) { return -1; });
  expect_delivery([](int from, int) { return from == 0 ? -1 : 2; });  // rank 0 sends nothing
  expect_delivery([](int, int to) { return to == 0 ? -1 : 2; });      // rank 0 receives nothing
}

TEST(Halo, RefreshesFieldsTogetherAsOneByOne) {
  const int self = rank_of(comm), ranks = ranks_of(comm), next = (self + 1) % ranks;
  const std::vector<int> index{2, 0};
  const Halo halo(Exchange(comm, std::vector<std::pair<int, int>>{{next, 2}}), index);
  const int before = (self + ranks - 1) % ranks;
  std::vector<std::uint8_t> mark{1, 0, static_cast<std::uint8_t>(2 + self), 9, 9};
  std::vector<double> number{0.5 + self, 1.5, 2.5, 0.0, 0.0};
  std::vector<Vector<3>> place(5);
  place[2] = {1.0, 2.0, 3.0 + self};
  auto mark_alone = mark;
  auto number_alone = number;
  auto place_alone = place;
  halo.refresh(mark_alone, 3);
  halo.refresh(number_alone, 3);
  halo.refresh(place_alone, 3);
  halo.refresh_together(3, mark, number, place);
  EXPECT_EQ(mark, mark_alone);
  EXPECT_EQ(number, number_alone);
  EXPECT_EQ(place, place_alone);
  EXPECT_EQ(mark[3], 2 + before);
  EXPECT_EQ(number[4], 0.5 + before);
  EXPECT_EQ(place[3][2], 3.0 + before);
}

TEST(Exchange, DeliversToTheSenderItself) {
  expect_delivery([](int from, int to) { return from == to ? 4 : -1; });
}

TEST(Exchange, ThatIsEmptyMovesNothing) {
  const Exchange nothing;
  EXPECT_EQ(nothing.n_send(), 0);
  EXPECT_EQ(nothing.n_receive(), 0);
  double value = 1.0;
  nothing.forward(&value, &value);
  EXPECT_EQ(value, 1.0);
}

TEST(Exchange, MakesARoundTrip) {
  const int self = rank_of(comm);
  const int n = ranks_of(comm);
  const Exchange there(comm, std::vector<std::pair<int, int>>{{(self + 1) % n, self + 1}});
  const Exchange back(comm, std::vector<std::pair<int, int>>{{(self + n - 1) % n, there.n_receive()}});
  std::vector<double> sent, abroad(static_cast<std::size_t>(there.n_receive()));
  for (int k = 0; k <= self; ++k) sent.push_back(100.0 * self + k);
  std::vector<double> returned(static_cast<std::size_t>(back.n_receive()));
  there.forward(sent.data(), abroad.data());
  back.forward(abroad.data(), returned.data());
  EXPECT_EQ(returned, sent);
}

TEST(Exchange, MovesWholeParticles) {
  const int self = rank_of(comm);
  const int n = ranks_of(comm);
  const auto particle = [](int rank) {
    return ParticleRecord<3>{{{1.0 * rank, 2.0, 3.0}}, {{4.0, 5.0, 6.0}}, 7.0, 8.0,
                             (1LL << 40) + rank,       ParticleType::wall};
  };
  const Exchange exchange(comm, std::vector<std::pair<int, int>>{{(self + 1) % n, 1}});
  const ParticleRecord<3> send = particle(self);
  ParticleRecord<3> received{};
  ASSERT_EQ(exchange.n_receive(), 1);
  exchange.forward(&send, &received);
  const ParticleRecord<3> expected = particle((self + n - 1) % n);
  EXPECT_EQ(received.position, expected.position);
  EXPECT_EQ(received.velocity, expected.velocity);
  EXPECT_EQ(received.pressure, expected.pressure);
  EXPECT_EQ(received.pressure_impulse, expected.pressure_impulse);
  EXPECT_EQ(received.id, expected.id);
  EXPECT_EQ(received.type, expected.type);
}

TEST(HaloOfARing, HoldsTheNeighboursValues) {
  const int self = rank_of(comm);
  const int n = ranks_of(comm);
  const int left = (self + n - 1) % n;
  const Halo halo(Exchange(comm, std::vector<std::pair<int, int>>{{(self + 1) % n, 3}}), {2, 0, 2});
  std::vector<double> field{10.0 * self, 10.0 * self + 1.0, 10.0 * self + 2.0, -1.0, -1.0, -1.0};
  halo.refresh(field, 3);
  EXPECT_EQ(field, (std::vector<double>{10.0 * self, 10.0 * self + 1.0, 10.0 * self + 2.0, 10.0 * left + 2.0,
                                        10.0 * left, 10.0 * left + 2.0}));
  std::vector<std::uint8_t> mark{static_cast<std::uint8_t>(self), 7, 9, 0, 0, 0};
  halo.refresh(mark, 3);
  EXPECT_EQ(mark,
            (std::vector<std::uint8_t>{static_cast<std::uint8_t>(self), 7, 9, 9, static_cast<std::uint8_t>(left), 9}));
}

TEST(Reductions, CoverAllRanks) {
  const int n = ranks_of(comm);
  EXPECT_EQ(sum_over_ranks(comm, std::int64_t{rank_of(comm) + 1}), n * (n + 1) / 2);
  EXPECT_EQ(sum_over_ranks(comm, 0.5), 0.5 * n);
  EXPECT_EQ(max_over_ranks(comm, -1.0 * rank_of(comm) - 1.0), -1.0);
  EXPECT_TRUE(any_rank(comm, rank_of(comm) == n - 1));
  EXPECT_FALSE(any_rank(comm, false));
}

}  // namespace
}  // namespace impinge
