// SPDX-License-Identifier: GPL-2.0-only
//
// fix helfrich: membranes of triangles in LAMMPS, by the C interface of the library helfrich.
//
//   fix ID group helfrich MESH EFFECTS [threads N]
//
// This file is a plugin of LAMMPS, derives from its classes, and is licensed under the GNU General Public
// License, version 2, as its host is. The library that it calls is licensed under MIT.
//
// Each molecule of the group is a membrane. Its atoms, sorted by their IDs, are the vertices of the mesh, whose
// positions in the file are the stress-free reference. A membrane is evaluated as a whole by one rank, to which
// positions are sent and from which forces come back. Each position and each force is moved and never summed
// on the way, so that the bits do not depend on the number of ranks. Their positions and velocities are the whole state
// of membranes, so that restart files need nothing of this fix.

#include "helfrich.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "lammps.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

using namespace LAMMPS_NS;

namespace {

using Point = std::array<double, 3>;

double (*rows(std::vector<Point> &points))[3]
{
  return reinterpret_cast<double(*)[3]>(points.data());
}

// An atom on its way to the rank that evaluates its membrane: the place of its vertex among those of all
// membranes, exact in a double, and its position without periodic wrapping.
struct Parcel {
  double place;
  Point position;
};

class FixHelfrich : public Fix {
 public:
  FixHelfrich(LAMMPS *, int, char **);
  ~FixHelfrich() override;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void min_setup(int) override;
  void post_force(int) override;
  void min_post_force(int) override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double compute_array(int, int) override;
  double memory_usage() override;

 private:
  static constexpr int OWN_COLUMNS = 3;    // energy, area, volume; then the energy of each effect

  hf_mesh *mesh = nullptr;
  hf_error failure;
  std::string effects;
  std::vector<Point> reference;
  bool closed = true;
  int threads = 1;
  int vertices = 0;
  int membranes = 0;                // of all ranks
  int effect_count = 0;
  std::vector<hf_membrane *> own;    // those that this rank evaluates: me, me + nprocs, …
  std::vector<Point> positions, forces;
  std::vector<double> energies;

  // The vertex of each atom: its place among those of all membranes, by the atom's ID, ascending.
  std::vector<std::pair<tagint, int>> places;
  // The same for the atom that each local index had last: atoms rarely move in memory.
  std::vector<std::pair<tagint, int>> known;

  // Buffers of the exchange, one part for each rank.
  std::vector<Parcel> sent, received;
  std::vector<Point> answers, answered;
  std::vector<int> atoms, send_counts, receive_counts;

  std::vector<double> table;    // of all membranes, on all ranks
  bigint table_step = -1;

  void check(hf_status, const char *);
  void assign();
  void make_membranes();
  void send_positions();
  void receive_forces();
  void fill_table();
};

void FixHelfrich::check(hf_status status, const char *what)
{
  if (status != HF_STATUS_OK) error->one(FLERR, "Fix helfrich {}: {}", what, failure.text);
}

FixHelfrich::FixHelfrich(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (narg != 5 && narg != 7)
    error->all(FLERR, "Fix helfrich has {} arguments: fix ID group helfrich MESH EFFECTS [threads N]",
               narg);
  if (hf_abi_version() != HF_ABI_VERSION)
    error->all(FLERR, "Fix helfrich was built for interface {} of the library, and runs with {}",
               HF_ABI_VERSION, hf_abi_version());
  if (!atom->molecule_flag || !atom->tag_enable)
    error->all(FLERR, "Fix helfrich requires an atom style with molecule and atom IDs");
  if (narg == 7) {
    if (strcmp(arg[5], "threads") != 0)
      error->all(FLERR, "Fix helfrich has no keyword {}: threads", arg[5]);
    threads = utils::inumeric(FLERR, arg[6], false, lmp);
    if (threads < 0) error->all(FLERR, "Fix helfrich threads is {}: 0 is all", threads);
  }
  std::ifstream file(arg[4]);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) error->one(FLERR, "Fix helfrich cannot read the file of effects {}", arg[4]);
  effects = text.str();

  check(hf_mesh_read(arg[3], 0, &mesh, &failure), "mesh");
  vertices = static_cast<int>(hf_mesh_vertex_count(mesh));
  reference.resize(vertices);
  check(hf_mesh_positions(mesh, rows(reference), vertices, &failure), "mesh");
  double volume;
  closed = hf_volume(mesh, rows(reference), vertices, &volume, nullptr) == HF_STATUS_OK;

  dynamic_group_allow = 0;
  scalar_flag = vector_flag = array_flag = 1;
  extscalar = extvector = 1;
  extarray = 0;
  global_freq = 1;
  energy_global_flag = thermo_energy = 1;
  virial_global_flag = virial_peratom_flag = thermo_virial = 1;
  assign();
  make_membranes();
}

FixHelfrich::~FixHelfrich()
{
  for (hf_membrane *membrane : own) hf_membrane_free(membrane);
  hf_mesh_free(mesh);
}

int FixHelfrich::setmask()
{
  return FixConst::POST_FORCE | FixConst::MIN_POST_FORCE;
}

void FixHelfrich::init()
{
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix helfrich does not support run_style respa");
  assign();
  make_membranes();
}

// Finds the vertex of each atom, and the number of membranes: molecules in ascending order, and in each the
// atoms by their IDs.
void FixHelfrich::assign()
{
  std::vector<std::array<tagint, 2>> mine, all;
  int stray = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    mine.push_back({atom->molecule[i], atom->tag[i]});
    if (atom->molecule[i] <= 0) stray++;
  }
  int strays;
  MPI_Allreduce(&stray, &strays, 1, MPI_INT, MPI_SUM, world);
  if (strays) error->all(FLERR, "Fix helfrich: {} atoms of the group are in no molecule", strays);

  std::vector<int> counts(comm->nprocs), starts(comm->nprocs);
  int count = 2 * static_cast<int>(mine.size()), total = 0;
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int rank = 0; rank < comm->nprocs; rank++) {
    starts[rank] = total;
    total += counts[rank];
  }
  all.resize(total / 2);
  MPI_Allgatherv(mine.data(), count, MPI_LMP_TAGINT, all.data(), counts.data(), starts.data(),
                 MPI_LMP_TAGINT, world);
  std::sort(all.begin(), all.end());

  membranes = 0;
  places.clear();
  known.clear();
  for (size_t start = 0; start < all.size(); membranes++) {
    size_t end = start;
    while (end < all.size() && all[end][0] == all[start][0]) end++;
    if (end - start != static_cast<size_t>(vertices))
      error->all(FLERR, "Fix helfrich: molecule {} has {} atoms in the group, and the mesh {} vertices",
                 all[start][0], end - start, vertices);
    for (size_t k = start; k < end; k++)
      places.emplace_back(all[k][1], membranes * vertices + static_cast<int>(k - start));
    start = end;
  }
  if (membranes == 0) error->all(FLERR, "Fix helfrich: the group has no atoms");
  std::sort(places.begin(), places.end());
  size_array_rows = membranes;
}

// Prepares the effects on the membranes that this rank evaluates, and asks the first for their number.
void FixHelfrich::make_membranes()
{
  const int me = comm->me, ranks = comm->nprocs;
  const size_t needed = me < membranes ? (membranes - me - 1) / ranks + 1 : 0;
  auto make = [this]() {
    hf_membrane *made = nullptr;
    check(hf_membrane_new(mesh, rows(reference), vertices, effects.c_str(), nullptr, 0, 1, &made,
                          &failure),
          "effects");
    return made;
  };
  while (own.size() > needed) {
    hf_membrane_free(own.back());
    own.pop_back();
  }
  while (own.size() < needed) own.push_back(make());
  hf_membrane *first = needed ? own[0] : make();
  effect_count = static_cast<int>(hf_membrane_effect_count(first));
  const bool exact = hf_membrane_constraint_count(first) > 0;
  if (!needed) hf_membrane_free(first);
  if (exact)
    error->all(FLERR, "Fix helfrich: a quantity is held exactly, and only forces act in LAMMPS: give it a "
                      "modulus instead of a constraint");
  size_vector = effect_count;
  size_array_cols = OWN_COLUMNS + effect_count;
  positions.resize(needed * vertices);
  forces.resize(needed * vertices);
  energies.assign(needed, 0.0);
  table_step = -1;
}

void FixHelfrich::setup(int vflag)
{
  post_force(vflag);
}

void FixHelfrich::min_setup(int vflag)
{
  post_force(vflag);
}

void FixHelfrich::min_post_force(int vflag)
{
  post_force(vflag);
}

// Sends the position of each atom to the rank that evaluates its membrane.
void FixHelfrich::send_positions()
{
  const int ranks = comm->nprocs;
  std::vector<std::vector<int>> of_rank(ranks);
  known.resize(atom->nlocal, {0, 0});
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (known[i].first != atom->tag[i]) {
      auto found = std::lower_bound(places.begin(), places.end(), std::make_pair(atom->tag[i], -1));
      if (found == places.end() || found->first != atom->tag[i])
        error->one(FLERR, "Fix helfrich: atom {} came into the group during a run", atom->tag[i]);
      known[i] = *found;
    }
    of_rank[(known[i].second / vertices) % ranks].push_back(i);
  }
  sent.clear();
  atoms.clear();
  send_counts.assign(ranks, 0);
  receive_counts.assign(ranks, 0);
  for (int rank = 0; rank < ranks; rank++) {
    for (int i : of_rank[rank]) {
      Parcel parcel;
      parcel.place = known[i].second;
      domain->unmap(atom->x[i], atom->image[i], parcel.position.data());
      sent.push_back(parcel);
      atoms.push_back(i);
    }
    send_counts[rank] = static_cast<int>(of_rank[rank].size());
  }
  MPI_Alltoall(send_counts.data(), 1, MPI_INT, receive_counts.data(), 1, MPI_INT, world);

  std::vector<int> sends(ranks), receives(ranks), send_starts(ranks), receive_starts(ranks);
  int out = 0, in = 0;
  for (int rank = 0; rank < ranks; rank++) {
    send_starts[rank] = 4 * out;
    receive_starts[rank] = 4 * in;
    out += send_counts[rank];
    in += receive_counts[rank];
    sends[rank] = 4 * send_counts[rank];
    receives[rank] = 4 * receive_counts[rank];
  }
  if (in != static_cast<int>(positions.size()))
    error->one(FLERR, "Fix helfrich: {} of the {} vertices are left: atoms were lost", in,
               positions.size());
  received.resize(in);
  MPI_Alltoallv(sent.data(), sends.data(), send_starts.data(), MPI_DOUBLE, received.data(),
                receives.data(), receive_starts.data(), MPI_DOUBLE, world);
  for (Parcel &parcel : received) {
    const int place = static_cast<int>(parcel.place);
    const int membrane = place / vertices / ranks;
    parcel.place = membrane * vertices + place % vertices;
    positions[static_cast<size_t>(parcel.place)] = parcel.position;
  }
}

// Sends the forces back by the way on which the positions came, and adds them.
void FixHelfrich::receive_forces()
{
  const int ranks = comm->nprocs;
  answers.resize(received.size());
  answered.resize(sent.size());
  for (size_t k = 0; k < received.size(); k++)
    answers[k] = forces[static_cast<size_t>(received[k].place)];
  std::vector<int> sends(ranks), receives(ranks), send_starts(ranks), receive_starts(ranks);
  int out = 0, in = 0;
  for (int rank = 0; rank < ranks; rank++) {
    send_starts[rank] = 3 * out;
    receive_starts[rank] = 3 * in;
    out += receive_counts[rank];
    in += send_counts[rank];
    sends[rank] = 3 * receive_counts[rank];
    receives[rank] = 3 * send_counts[rank];
  }
  MPI_Alltoallv(answers.data(), sends.data(), send_starts.data(), MPI_DOUBLE, answered.data(),
                receives.data(), receive_starts.data(), MPI_DOUBLE, world);
  for (size_t k = 0; k < atoms.size(); k++) {
    const int i = atoms[k];
    const Point &force = answered[k];
    for (int axis = 0; axis < 3; axis++) atom->f[i][axis] += force[axis];
    if (!evflag) continue;
    const Point &x = sent[k].position;
    double virial[6] = {force[0] * x[0], force[1] * x[1], force[2] * x[2],
                        force[0] * x[1], force[0] * x[2], force[1] * x[2]};
    v_tally(i, virial);
  }
}

void FixHelfrich::post_force(int vflag)
{
  v_init(vflag);
  send_positions();
  if (!own.empty())
    check(hf_membranes_force(own.data(), own.size(), rows(positions), rows(forces),
                             positions.size(), energies.data(), threads, &failure),
          "evaluation");
  receive_forces();
  table_step = -1;
}

// Gathers the numbers of all membranes on all ranks. Each number comes from one rank, and 0 from the others.
void FixHelfrich::fill_table()
{
  if (table_step == update->ntimestep) return;
  table_step = update->ntimestep;
  const int columns = size_array_cols;
  std::vector<double> mine(static_cast<size_t>(membranes) * columns, 0.0);
  for (size_t k = 0; k < own.size(); k++) {
    double *row = &mine[(comm->me + k * comm->nprocs) * columns];
    auto at = rows(positions) + k * vertices;
    row[0] = energies[k];
    check(hf_area(mesh, at, vertices, row + 1, &failure), "area");
    if (closed) check(hf_volume(mesh, at, vertices, row + 2, &failure), "volume");
    check(hf_membrane_effect_forces(own[k], at, vertices, row + OWN_COLUMNS, nullptr, effect_count,
                                    &failure),
          "energies");
  }
  table.resize(mine.size());
  MPI_Allreduce(mine.data(), table.data(), static_cast<int>(mine.size()), MPI_DOUBLE, MPI_SUM, world);
}

// Energy of all membranes.
double FixHelfrich::compute_scalar()
{
  fill_table();
  double sum = 0.0;
  for (int k = 0; k < membranes; k++) sum += table[k * size_array_cols];
  return sum;
}

// Energy of one effect on all membranes.
double FixHelfrich::compute_vector(int effect)
{
  fill_table();
  double sum = 0.0;
  for (int k = 0; k < membranes; k++) sum += table[k * size_array_cols + OWN_COLUMNS + effect];
  return sum;
}

// Of one membrane: its energy, area and volume (0 if it is open), and the energy of each effect.
double FixHelfrich::compute_array(int membrane, int column)
{
  fill_table();
  return table[membrane * size_array_cols + column];
}

double FixHelfrich::memory_usage()
{
  return static_cast<double>((places.size() + known.size()) * sizeof(places[0]) +
                             2 * positions.size() * sizeof(Point));
}

}    // namespace

// The interface of plugins. Wheels have no lammpsplugin.h: these are its declarations.
extern "C" {
typedef void *(lammpsplugin_factory1) (void *);
typedef void *(lammpsplugin_factory2) (void *, int, char **);

typedef struct {
  const char *version;
  const char *style;
  const char *name;
  const char *info;
  const char *author;
  union {
    lammpsplugin_factory1 *v1;
    lammpsplugin_factory2 *v2;
  } creator;
  void *handle;
} lammpsplugin_t;

typedef void (*lammpsplugin_regfunc)(lammpsplugin_t *, void *);

void lammpsplugin_init(void *lmp, void *handle, void *regfunc)
{
  lammpsplugin_t plugin;
  plugin.version = HELFRICH_LAMMPS_VERSION;
  plugin.style = "fix";
  plugin.name = "helfrich";
  plugin.info = "bending and elasticity of triangulated membranes, fix helfrich";
  plugin.author = "helfrich maintainers";
  plugin.creator.v2 = [](void *lmp, int narg, char **arg) -> void * {
    return new FixHelfrich(static_cast<LAMMPS *>(lmp), narg, arg);
  };
  plugin.handle = handle;
  reinterpret_cast<lammpsplugin_regfunc>(regfunc)(&plugin, lmp);
}
}
