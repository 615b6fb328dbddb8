#pragma once

#include <string>

namespace mica::host {

/// How many threads this process should run at a time: the least of the processors that it may run on, of
/// those that its control group may use (of a quota, the part begun counts as one), and of
/// SLURM_CPUS_PER_TASK or, without it, SLURM_CPUS_ON_NODE. At least 1.
int usable_processors();

/// The least quota that the control groups of /proc/self/cgroup have, in processors; 0: none.
/// @param root where version 2 and the controller `cpu` of version 1 are mounted.
double processor_quota(const std::string& memberships, const std::string& root);

}  // namespace mica::host
