// Counts what a program's own MPI calls send, by MPI's profiling interface: preloaded, it stands before the library.
// At MPI_Finalize rank 0 writes COUNT_MPI_FILE (CSV), a line per rank: point-to-point messages, their bytes and
// collective operations over more than one rank. What MPI sends within a collective operation or a file access is not
// seen.

#include <mpi.h>

#include <cstdlib>
#include <fstream>
#include <unordered_map>
#include <vector>

namespace {

enum Count { messages, bytes, reductions, other_collectives, n_counts };
long long counts[n_counts];

std::unordered_map<MPI_Request, long long>& persistent_bytes() {
  static std::unordered_map<MPI_Request, long long> requests;
  return requests;
}

long long size_of(int n, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return static_cast<long long>(n) * size;
}

void count_message(long long size) {
  ++counts[messages];
  counts[bytes] += size;
}

void count_start(MPI_Request request) {
  const auto known = persistent_bytes().find(request);
  if (known != persistent_bytes().end()) count_message(known->second);
}

void count_collective(MPI_Comm comm, Count kind) {
  int size = 0;
  PMPI_Comm_size(comm, &size);
  if (size > 1) ++counts[kind];
}

}  // namespace

#define COUNTED_SEND(name)                                                                       \
  int MPI_##name(const void* buffer, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm) { \
    count_message(size_of(n, type));                                                             \
    return PMPI_##name(buffer, n, type, to, tag, comm);                                          \
  }
#define COUNTED_ISEND(name)                                                                                      \
  int MPI_##name(const void* buffer, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* r) { \
    count_message(size_of(n, type));                                                                             \
    return PMPI_##name(buffer, n, type, to, tag, comm, r);                                                       \
  }
#define COUNTED_COLLECTIVE(name, kind, parameters, arguments) \
  int MPI_##name parameters {                                 \
    count_collective(comm, kind);                             \
    return PMPI_##name arguments;                             \
  }

extern "C" {

COUNTED_SEND(Send)
COUNTED_SEND(Ssend)
COUNTED_SEND(Rsend)
COUNTED_SEND(Bsend)
COUNTED_ISEND(Isend)
COUNTED_ISEND(Issend)
COUNTED_ISEND(Irsend)
COUNTED_ISEND(Ibsend)

int MPI_Send_init(const void* buffer, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) {
  const int code = PMPI_Send_init(buffer, n, type, to, tag, comm, request);
  persistent_bytes()[*request] = size_of(n, type);
  return code;
}

int MPI_Start(MPI_Request* request) {
  count_start(*request);
  return PMPI_Start(request);
}

int MPI_Startall(int n, MPI_Request requests[]) {
  for (int k = 0; k < n; ++k) count_start(requests[k]);
  return PMPI_Startall(n, requests);
}

int MPI_Request_free(MPI_Request* request) {
  persistent_bytes().erase(*request);
  return PMPI_Request_free(request);
}

COUNTED_COLLECTIVE(Allreduce, reductions,
                   (const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm),
                   (in, out, n, type, op, comm))
COUNTED_COLLECTIVE(Iallreduce, reductions,
                   (const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm, MPI_Request* r),
                   (in, out, n, type, op, comm, r))
COUNTED_COLLECTIVE(Reduce, reductions,
                   (const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm),
                   (in, out, n, type, op, root, comm))
COUNTED_COLLECTIVE(Scan, reductions, (const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm),
                   (in, out, n, type, op, comm))
COUNTED_COLLECTIVE(Exscan, reductions, (const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm),
                   (in, out, n, type, op, comm))
COUNTED_COLLECTIVE(Reduce_scatter, reductions,
                   (const void* in, void* out, const int n[], MPI_Datatype type, MPI_Op op, MPI_Comm comm),
                   (in, out, n, type, op, comm))
COUNTED_COLLECTIVE(Reduce_scatter_block, reductions,
                   (const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm),
                   (in, out, n, type, op, comm))
COUNTED_COLLECTIVE(Barrier, other_collectives, (MPI_Comm comm), (comm))
COUNTED_COLLECTIVE(Ibarrier, other_collectives, (MPI_Comm comm, MPI_Request* r), (comm, r))
COUNTED_COLLECTIVE(Bcast, other_collectives, (void* buffer, int n, MPI_Datatype type, int root, MPI_Comm comm),
                   (buffer, n, type, root, comm))
COUNTED_COLLECTIVE(Gather, other_collectives,
                   (const void* in, int n, MPI_Datatype type, void* out, int m, MPI_Datatype to, int root,
                    MPI_Comm comm),
                   (in, n, type, out, m, to, root, comm))
COUNTED_COLLECTIVE(Gatherv, other_collectives,
                   (const void* in, int n, MPI_Datatype type, void* out, const int m[], const int at[], MPI_Datatype to,
                    int root, MPI_Comm comm),
                   (in, n, type, out, m, at, to, root, comm))
COUNTED_COLLECTIVE(Scatter, other_collectives,
                   (const void* in, int n, MPI_Datatype type, void* out, int m, MPI_Datatype to, int root,
                    MPI_Comm comm),
                   (in, n, type, out, m, to, root, comm))
COUNTED_COLLECTIVE(Scatterv, other_collectives,
                   (const void* in, const int n[], const int at[], MPI_Datatype type, void* out, int m, MPI_Datatype to,
                    int root, MPI_Comm comm),
                   (in, n, at, type, out, m, to, root, comm))
COUNTED_COLLECTIVE(Allgather, other_collectives,
                   (const void* in, int n, MPI_Datatype type, void* out, int m, MPI_Datatype to, MPI_Comm comm),
                   (in, n, type, out, m, to, comm))
COUNTED_COLLECTIVE(Allgatherv, other_collectives,
                   (const void* in, int n, MPI_Datatype type, void* out, const int m[], const int at[], MPI_Datatype to,
                    MPI_Comm comm),
                   (in, n, type, out, m, at, to, comm))
COUNTED_COLLECTIVE(Alltoall, other_collectives,
                   (const void* in, int n, MPI_Datatype type, void* out, int m, MPI_Datatype to, MPI_Comm comm),
                   (in, n, type, out, m, to, comm))
COUNTED_COLLECTIVE(Alltoallv, other_collectives,
                   (const void* in, const int n[], const int at[], MPI_Datatype type, void* out, const int m[],
                    const int to_at[], MPI_Datatype to, MPI_Comm comm),
                   (in, n, at, type, out, m, to_at, to, comm))

int MPI_Finalize() {
  int rank = 0, ranks = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  PMPI_Comm_size(MPI_COMM_WORLD, &ranks);
  std::vector<long long> all(static_cast<std::size_t>(ranks) * n_counts);
  PMPI_Gather(counts, n_counts, MPI_LONG_LONG, all.data(), n_counts, MPI_LONG_LONG, 0, MPI_COMM_WORLD);
  const char* path = std::getenv("COUNT_MPI_FILE");
  if (rank == 0 && path != nullptr) {
    std::ofstream file(path);
    file << "rank,messages,bytes,reductions,other_collectives\n";
    for (int r = 0; r < ranks; ++r) {
      file << r;
      for (int k = 0; k < n_counts; ++k) file << ',' << all[static_cast<std::size_t>(r * n_counts + k)];
      file << '\n';
    }
  }
  return PMPI_Finalize();
}

}  // extern "C"
