// Launches the iteration of a part on a GPU; the other parts are threads of this process with GPUs of their own.
#pragma once
#include "base/parallel/device.h"
#include "base/ranks/ranks.h"
#include "sim/simulation/layout/part.h"
#include "sim/simulation/parts/part_kernel.cuh"
#include "sim/simulation/parts/part_lists.h"
#include "sim/solver/cuda/launch.cuh"

namespace gonogo::sim {

template <class Exec>
class PartSolver;

template <>
class PartSolver<Cuda> {
 public:
  PartSolver(Ranks& ranks, const Part& part, const FlatWorld& world)
      : ranks_(ranks), part_(part), sharing_device_(meet_peers()) {
    std::vector<MovedBy> moved_by;
    std::vector<WorldIndex> moved_world;
    for (std::size_t b = 0; b < part.body.size(); ++b) {
      const bool free = part.is_shared[b] && !is_fixed(world.mass[b]), halo = part.strangeness[b] == halo_body;
      moved_by.push_back(free ? MovedBy::all : halo ? MovedBy::owner : MovedBy::own);
      moved_world.push_back(moved_by.back() == MovedBy::own || world.mass[b].slot >= 0 ? 0 : -1);
    }
    moved_by_.upload(moved_by);
    moved_world_.upload(moved_world);
    lay_out_borders();
    for (Buffer<Velocity, Cuda>& halo : halo_) halo.resize(std::size_t(received_.size()));
    weight_.resize(std::size_t(received_.size()));
    wanted_.resize(std::size_t(sent_.size()));
    used_.resize(part.body.size());
    for (auto& partial : partial_) partial.resize(kMaxGpus * kTileSize);
    partial_measure_.resize(kMaxGpus * kTileSize);
    body_measure_.resize(std::size_t(views_.world_body_tiles));
    arrived_.fill_zero(kMaxGpus);
  }

  void reserve(State<Cuda>& s, const StepSettings& settings) { reserve_solver(s, own_, settings); }

  /// The contract of solve.h, for the bodies and contacts of the part. Every part calls it at once, and returns when
  /// its GPU has finished.
  void solve(Cuda exec, State<Cuda>& s, const PartContacts& contacts, const StepSettings& settings) {
    const bool in_substeps = settings.substeps > 1;
    const auto kernel = s.turning ? (in_substeps ? solve_part_kernel<true, true> : solve_part_kernel<true, false>)
                                  : (in_substeps ? solve_part_kernel<false, true> : solve_part_kernel<false, false>);
    cudaFuncAttributes loaded;  // loading it may wait for kernels, which wait for this one
    check_cuda(cudaFuncGetAttributes(&loaded, kernel), "solver");
    reserve(s, settings);
    clear(exec, own_.counter.view());
    clear(exec, used_.view());
    place_contacts(contacts);
    list_records(contacts);
    share_mail();
    launch(exec, s, settings, kernel);
    check_cuda(cudaStreamSynchronize(stream_of(exec)), "solver");
  }

 private:
  std::size_t me() const { return std::size_t(ranks_.rank()); }

  /// Lets the GPUs write into each other's memory. Returns how many ranks share this one's GPU.
  int meet_peers() {
    if (ranks_.count() > kMaxGpus)
      throw InputError("a world is to be divided over " + std::to_string(ranks_.count()) + " GPUs; allowed are 1 to " +
                       std::to_string(kMaxGpus));
    int own = 0, sharing = 0;
    check_cuda(cudaGetDevice(&own), "device");
    for (const int other : joined(ranks_, std::vector<int>{own})) {
      if (other == own) {
        ++sharing;
        continue;
      }
      int reaches = 0;
      check_cuda(cudaDeviceCanAccessPeer(&reaches, own, other), "peer access");
      if (reaches == 0)
        throw DeviceError("GPU " + std::to_string(own) + " cannot reach the memory of GPU " + std::to_string(other) +
                          "; use GPUs that are linked, or one");
      const cudaError_t status = cudaDeviceEnablePeerAccess(other, 0);
      if (status != cudaErrorPeerAccessAlreadyEnabled) check_cuda(status, "peer access");
      cudaGetLastError();  // else the next kernel's check would find this error
    }
    return sharing;
  }

  /// Where the bodies of each rank lie in the lists, and in the halos of the others.
  void lay_out_borders() {
    std::vector<BodyIndex> sent, received;
    std::vector<Index> inbox;  // [rank] where its bodies begin in the halo of this one
    for (std::size_t r = 0; r < part_.sent.size(); ++r) {
      views_.sent_begin[r] = Index(sent.size());
      views_.received_begin[r] = Index(received.size());
      inbox.push_back(Index(received.size()));
      sent.insert(sent.end(), part_.sent[r].begin(), part_.sent[r].end());
      received.insert(received.end(), part_.received[r].begin(), part_.received[r].end());
    }
    views_.sent_begin[part_.sent.size()] = Index(sent.size());
    views_.received_begin[part_.sent.size()] = Index(received.size());
    const auto inboxes = gathered(ranks_, inbox);
    const auto outboxes = gathered(ranks_, std::vector<Index>(views_.sent_begin, views_.sent_begin + inbox.size()));
    for (std::size_t r = 0; r < inboxes.size(); ++r) {
      views_.inbox_begin[r] = inboxes[r][me()];
      views_.outbox_begin[r] = outboxes[r][me()];
    }
    sent_.upload(sent);
    received_.upload(received);
    shared_.upload(part_.moving_shared);
    views_.rank = ranks_.rank();
    views_.count = ranks_.count();
    views_.own_begin = part_.own_begin;
    views_.own_end = part_.own_end;
    const auto tiles = [](Index bodies) { return (bodies + kTileSize - 1) / kTileSize; };
    views_.first_body_tile = views_.world_body_tiles = 0;
    const auto bodies = gathered(ranks_, std::vector<Index>{part_.own_count()});
    for (std::size_t r = 0; r < bodies.size(); ++r) {
      if (r == me()) views_.first_body_tile = views_.world_body_tiles;
      views_.world_body_tiles += tiles(bodies[r][0]);
    }
  }

  void place_contacts(const PartContacts& c) {
    const TileCut& cut = c.cut[me()];
    views_.tiles = c.tiles;
    views_.whole = cut.whole;
    views_.tail = cut.tail;
    views_.first_tile = Index((c.before + cut.head) / kTileSize);
    views_.world_contacts = Index(c.total);
    views_.world_tiles = Index((c.total + kTileSize - 1) / kTileSize);
    views_.partial_count = 0;
    std::int64_t before = 0;
    for (std::size_t r = 0; r < c.cut.size(); before += c.count[r++][0]) {
      const Index offset = Index(before % kTileSize);
      if (r == me()) views_.head_place = (views_.partial_count - 1) * kTileSize + offset;
      if (c.cut[r].tail > 0) {
        const std::int64_t tile = (before + c.count[r][0]) / kTileSize;
        views_.partial_tile[views_.partial_count] = Index(tile);
        views_.partial_contacts[views_.partial_count] =
            Index(std::min<std::int64_t>(kTileSize, c.total - tile * kTileSize));
        if (r == me()) views_.tail_place = views_.partial_count * kTileSize;
        ++views_.partial_count;
      }
    }
    for (auto& tile : tile_) tile.resize(std::size_t(views_.world_tiles));
    tile_measure_.resize(std::size_t(views_.world_tiles));
  }

  /// Wrenches on each shared body in turn: those of all parts where it owns the contact, then where it is body b.
  void list_records(const PartContacts& c) {
    std::vector<PartRecord> record;
    std::vector<HalfRange> range;
    Index at = 0;
    for (std::size_t k = 0; k < c.shared.size(); ++k) {
      const SharedContacts& of = c.shared[k];
      range.push_back({at, at});
      for (std::size_t r = 0; r < c.count.size(); at += c.owned_of(r++, k))
        for (Index n = 0; r == me() && n < c.owned_of(r, k); ++n)
          record.push_back({of.owned.begin + n + of.first_second, at + n});
      for (std::size_t r = 0; r < c.count.size(); at += c.second_of(r++, k))
        for (Index n = 0; r == me() && n < c.second_of(r, k); ++n)
          record.push_back({of.owned_end + of.second.begin + n, at + n});
      range.back().end = at;
    }
    record_.upload(record);
    range_.upload(range);
    for (auto& wrench : wrench_) wrench.resize(std::size_t(at));
  }

  /// Tells the others where to write, when all have made room and nobody allocates any more.
  void share_mail() {
    PartMail own;
    for (int k = 0; k < 2; ++k) {
      own.halo[k] = halo_[k].data();
      own.wrench[k] = wrench_[k].data();
      own.tile[k] = tile_[k].data();
      own.partial[k] = partial_[k].data();
    }
    own.tile_measure = tile_measure_.data();
    own.partial_measure = partial_measure_.data();
    own.body_measure = body_measure_.data();
    own.weight = weight_.data();
    own.wanted = wanted_.data();
    own.arrived = arrived_.data();
    std::vector<std::vector<PartMail>> all(std::size_t(ranks_.count()), std::vector<PartMail>(1));
    share(ranks_, {own}, all);
    for (std::size_t r = 0; r < all.size(); ++r) views_.mail[r] = all[r][0];
    views_.moved_by = moved_by_.view();
    views_.sent = sent_.view();
    views_.received = received_.view();
    views_.shared = shared_.view();
    views_.shared_wrenches = range_.view();
    views_.record = record_.view();
    views_.used = used_.view();
  }

  void launch(Cuda exec, State<Cuda>& s, const StepSettings& settings, void (*kernel)(SolveViews, PartViews)) {
    SolveViews views = solve_views(exec, s, own_, settings);
    views.world_of_body = moved_world_.view();  // of bodies that this part alone moves
    views.mechanism_teams = 0;
    views_.weight = s.contact_weight.view();
    const Index share = device_attribute(cudaDevAttrMultiProcessorCount) / sharing_device_;
    const Index blocks = std::max<Index>(1, std::min(grid_size(s), share));
    void* arguments[] = {&views, &views_};
    check_cuda(
        cudaLaunchCooperativeKernel(kernel, dim3(unsigned(blocks)), dim3(kBlockSize), arguments, 0, stream_of(exec)),
        "solver launch");
  }

  Ranks& ranks_;
  const Part& part_;
  int sharing_device_;
  PartViews views_{};
  SolverStorage<Cuda> own_;
  Buffer<MovedBy, Cuda> moved_by_;
  Buffer<WorldIndex, Cuda> moved_world_;
  Buffer<BodyIndex, Cuda> sent_, received_, shared_;
  Buffer<Index, Cuda> weight_;
  Buffer<std::uint8_t, Cuda> wanted_, used_;
  Buffer<PartRecord, Cuda> record_;
  Buffer<HalfRange, Cuda> range_;
  Buffer<Velocity, Cuda> halo_[2];
  Buffer<Wrench, Cuda> wrench_[2];
  Buffer<UpdateSums, Cuda> tile_[2], partial_[2];
  Buffer<WorldSums, Cuda> tile_measure_, partial_measure_, body_measure_;
  Buffer<unsigned long long, Cuda> arrived_;
};

}  // namespace gonogo::sim
