"""Whitened residual of diagnosis: the part of the unexplained lateral force and torque that cannot be
predicted from its past, and the signature that a thruster fault leaves in it.

Air, riser and the vibration of the engine disturb the vehicle far more than a small thruster does, but most
of this disturbance is predictable over a control cycle: the air within a second, the vibration as a tone. The
change x of the unexplained force or torque per cycle is modelled as autoregressive for each component,

    x_k = a_1 x_(k-1) + ... + a_n x_(k-n) + e_k

and diagnosis uses the innovation e, whose variance shows the size of the unpredictable part. A fault adds to
the unexplained wrench its effect b times a known level s_k (the share of the cycle in which thrust is
missing), hence to the innovation

    b (1 - z^-1) (1 - a_1 z^-1 - ... - a_n z^-n) s

Air and riser act at a distance from the centre of mass, and so cause a lateral force and a torque together:
y force and z torque, z force and y torque. The torque innovation less its regression on the force innovation
of the same plane is free of most of that; the same regression applies to signatures. Roll, and these two
planes, are independent of each other, so that a disturbance in one of them does not hide a fault from
another.

The coefficients follow from running covariances of x by the Levinson-Durbin recursion, one component per
cycle. A fault must not change the model that judges it: in the covariances each innovation is limited to a
few standard deviations, and they end ``DELAY`` cycles ago.

Sources: Basseville & Nikiforov 1993, chapter 7 (additive changes: likelihood ratio of the innovations); Box,
Jenkins & Reinsel, Time Series Analysis, chapter 3 (Yule-Walker equations, recursion); Martin & Thomson 1982,
Proc. IEEE 70(9) (limited innovations).
"""

from __future__ import annotations

from math import sqrt

from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record

AXES = 5  # components: lateral force y, z and torque x, y, z; engine and drag disturb the axial force
PLANES = 3  # roll; force y and torque z; force z and torque y
PLANE = (1, 2, 0, 2, 1)  # of each component
ORDER = 4  # of the autoregressive model: drift and one tone
TAPS = ORDER + 2  # of the filter from the unexplained wrench to the innovation
DELAY = 6  # cycles: longest onset of a fault, in which the model does not adapt to it yet
WINDOW = 4  # innovations that are stored, for the onset of a leak
MEMORY = 60.0  # cycles of the covariances: 2.4 s
CLIP = 3.0  # standard deviations to which an innovation counts in the covariances
WHITE = 1.005  # factor on the variance of x, which limits the range of the spectrum that is removed
LARGEST_REFLECTION = 0.98
STEADY = 0.99  # share of a cycle from which a thruster counts as open throughout

RESIDUAL = record(
    ("taken", COUNT),  # cycles
    ("settled", COUNT),  # cycles since the last restart
    ("last", "f8", (AXES,)),  # N, N m: unexplained wrench of the last cycle
    ("change", "f8", (ORDER + 1, AXES)),  # N, N m: x, the latest first
    ("usual", "f8", (DELAY + ORDER + 1, AXES)),  # N, N m: x with limited innovations, a ring
    ("covariance", "f8", (AXES, ORDER + 1)),  # N2, (N m)2: of the limited x, by lag
    ("predictor", "f8", (AXES, ORDER)),  # a_1 to a_n of each component
    ("variance", "f8", (AXES,)),  # N2, (N m)2: of the innovation
    ("filter", "f8", (TAPS, AXES)),  # from the unexplained wrench to the innovation, the latest first
    ("share", "f8", (TAPS, MAX_THRUSTERS)),  # of the cycle in which each thruster was commanded, a ring
    ("wrench", "f8", (TAPS, AXES)),  # N, N m: commanded, a ring
    ("idle", COUNT, (MAX_THRUSTERS,)),  # cycles since each thruster was commanded
    ("limited", "f8", (AXES,)),  # N, N m: latest innovation, limited
    ("joint", "f8", (2,)),  # N2 m: covariance of limited innovations of torque y and force z; z and y
    ("slope", "f8", (2,)),  # m: regression of these torques on these forces
    ("left", "f8", (2,)),  # (N m)2: variance of these torques less their regression
    ("value", "f8", (WINDOW, AXES)),  # N, N m: innovations, torques less their regression; a ring
    ("weight", "f8", (WINDOW, AXES)),  # 1/N2, 1/(N m)2: inverse variances of these
    ("square", "f8", (WINDOW, PLANES)),  # weighted sums of squares of these
    ("signature", "f8", (AXES,)),  # N, N m: innovation that a fault predicts
    ("presumed", "f8", (2, AXES)),  # N, N m: change and innovation of the next cycle by a presumed leak
    ("product", "f8", (2, PLANES)),  # weighted products of innovation and signature, and of the latter
)


@kernel
def restart_residual(memory):
    """Wait until the filter has passed a change of the vehicle or of the forces on it."""
    memory.settled = 0


@kernel
def is_settled(memory):
    """Return whether the filter and the stored innovations date from after the last restart."""
    return memory.settled > TAPS + WINDOW


@kernel
def predict_by_covariance(covariance, predictor):
    """Write the coefficients that predict a series with these covariances (by lag, the variance first) into
    ``predictor`` (Levinson-Durbin recursion).
    """
    left = WHITE * covariance[0]
    if left <= 0.0:
        return
    for m in range(ORDER):
        rest = covariance[m + 1]
        for j in range(m):
            rest -= predictor[j] * covariance[m - j]
        reflection = min(max(rest / left, -LARGEST_REFLECTION), LARGEST_REFLECTION)
        for j in range((m + 1) // 2):
            first, last = predictor[j], predictor[m - 1 - j]
            predictor[j] = first - reflection * last
            predictor[m - 1 - j] = last - reflection * first
        predictor[m] = reflection
        left *= 1.0 - reflection * reflection


@kernel
def update_filter(c, memory):
    """Compute predictor and filter of component ``c`` again, from its covariances."""
    predict_by_covariance(memory.covariance[c], memory.predictor[c])
    before = 1.0
    memory.filter[0, c] = 1.0
    for j in range(ORDER):
        memory.filter[j + 1, c] = -memory.predictor[c, j] - before
        before = -memory.predictor[c, j]
    memory.filter[ORDER + 1, c] = -before


@kernel
def limit(innovation, variance, least):
    """Return an innovation limited to a few standard deviations."""
    most = CLIP * sqrt(variance + least * least)
    return min(max(innovation, -most), most)


@kernel
def decorrelate(values, memory):
    """Subtract from the lateral torques of an innovation, or of a signature, their regression on the lateral
    forces.
    """
    for k in range(2):
        values[3 + k] -= memory.slope[k] * values[1 - k]


@kernel
def update_regression(params, new, memory):
    """Add the latest innovation, without that of a presumed leak, to the regression of lateral torques on
    lateral forces.
    """
    for k in range(2):
        least, own = least_noise(params, 1 - k), least_noise(params, 3 + k)
        left = limit(memory.value[new, 3 + k] - memory.presumed[1, 3 + k], memory.left[k], own)
        memory.left[k] += (left * left - memory.left[k]) / MEMORY
        memory.joint[k] += (memory.limited[3 + k] * memory.limited[1 - k] - memory.joint[k]) / MEMORY
        memory.slope[k] = memory.joint[k] / (memory.variance[1 - k] + least * least)


@kernel
def update_statistics(c, least, memory):
    """Add the latest change of component ``c`` without a presumed leak, its innovation limited, to the ring
    and to the variance of the innovation, and the change ``DELAY`` cycles ago to the covariances; ``least``:
    smallest standard deviation of the innovation.
    """
    size, k = DELAY + ORDER + 1, memory.taken
    usual = 0.0
    for j in range(ORDER):
        usual += memory.predictor[c, j] * memory.usual[(k - 1 - j) % size, c]
    limited = limit(memory.change[0, c] - memory.presumed[0, c] - usual, memory.variance[c], least)
    memory.limited[c] = limited
    memory.variance[c] += (limited * limited - memory.variance[c]) / MEMORY
    memory.usual[k % size, c] = usual + limited
    older = memory.usual[(k - DELAY) % size, c]
    for j in range(ORDER + 1):
        product = older * memory.usual[(k - DELAY - j) % size, c]
        memory.covariance[c, j] += (product - memory.covariance[c, j]) / MEMORY


@kernel
def whiten(params, unexplained, activity, count, memory):
    """Add a cycle: the innovation of each component, its weight, and then the model.

    Args:
        params: diagnosis record.
        unexplained: force and torque of the measured cycle that the commands do not explain (6; N, N m, B).
        activity: ``ACTIVITY`` record of the measured cycle; a fraction of its wrench is model error.
        count: number of thrusters.
        memory: ``RESIDUAL`` record, updated.
    """
    k = memory.taken
    row, new = k % TAPS, k % WINDOW
    for i in range(count):
        memory.share[row, i] = activity.share[i]
        memory.idle[i] = 0 if activity.share[i] > 0.0 else memory.idle[i] + 1
    for c in range(AXES):
        for j in range(ORDER, 0, -1):
            memory.change[j, c] = memory.change[j - 1, c]
        memory.change[0, c] = unexplained[c + 1] - memory.last[c] if k > 0 else 0.0
        memory.last[c] = unexplained[c + 1]
        memory.wrench[row, c] = activity.wrench[c + 1]
        innovation, commanded = memory.change[0, c], 0.0
        for j in range(ORDER):
            innovation -= memory.predictor[c, j] * memory.change[j + 1, c]
        for j in range(TAPS):
            commanded += memory.filter[j, c] * memory.wrench[(row - j) % TAPS, c]
        memory.value[new, c], memory.signature[c] = innovation, params.model_error * commanded
    decorrelate(memory.value[new], memory)
    decorrelate(memory.signature, memory)
    memory.square[new] = 0.0
    for c in range(AXES):
        least, error = least_noise(params, c), memory.signature[c]
        variance = memory.variance[c] if c < 3 else memory.left[c - 3]
        weight = 1.0 / (variance + least * least + error * error)
        memory.weight[new, c] = weight
        memory.square[new, PLANE[c]] += weight * memory.value[new, c] * memory.value[new, c]
        update_statistics(c, least, memory)
    update_regression(params, new, memory)
    update_filter(k % AXES, memory)
    memory.presumed[:] = 0.0
    memory.taken += 1
    memory.settled += 1


@kernel
def least_noise(params, c):
    """Return the smallest standard deviation of the innovation of component ``c``, N or N m."""
    return params.force_noise if c < 2 else params.torque_noise


@kernel
def add_response(level, j, effectiveness, memory):
    """Add to ``memory.signature`` the innovation that a thruster causes ``j`` cycles after it fired for the
    share ``level`` of a cycle; ``effectiveness``: its force and torque (6; N, N m).
    """
    for c in range(AXES):
        memory.signature[c] += level * memory.filter[j, c] * effectiveness[c + 1]


@kernel
def add_signature(i, effectiveness, memory):
    """Add the innovation that a thruster ``i`` without thrust causes to ``memory.signature``."""
    for j in range(TAPS):
        share = memory.share[(memory.taken - 1 - j) % TAPS, i]
        if share != 0.0:
            add_response(-share, j, effectiveness, memory)


@kernel
def fires_steadily(i, memory):
    """Return whether thruster ``i`` was commanded throughout the cycles that the filter contains: it then
    leaves no signature.
    """
    least = 1.0
    for j in range(TAPS):
        least = min(least, memory.share[j, i])
    return least > STEADY


@kernel
def fires_mostly(i, memory):
    """Return whether thruster ``i`` was commanded for more than half of what the filter contains."""
    total = 0.0
    for j in range(TAPS):
        total += memory.share[j, i]
    return total > 0.5 * TAPS


@kernel
def compare_signature(k, memory):
    """Add, for each plane, the weighted products of the innovation of cycle ``k`` with ``memory.signature``
    to row 0 of ``memory.product``, and those of the latter with itself to row 1.
    """
    for c in range(AXES):
        own = memory.signature[c]
        if c >= 3:
            own -= memory.slope[c - 3] * memory.signature[4 - c]
        predicted = memory.weight[k % WINDOW, c] * own
        memory.product[0, PLANE[c]] += predicted * memory.value[k % WINDOW, c]
        memory.product[1, PLANE[c]] += predicted * own
