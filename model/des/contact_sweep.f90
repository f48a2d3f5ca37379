!> One pass over all listed pairs: select those that touch, gather a block of them, let the law compute their
!> forces eight at a time, and hand the forces out.
!>
!> Half of the listed pairs do not touch, in no order a processor could foresee; so the selection has no branch,
!> and the law sees only pairs that touch.
module contact_sweep
  use contact_lanes, only: lanes
  use contact_law, only: contact_law_t, friction_forces, frictionless_forces
  use contact_list, only: contact_list_t
  use kinds, only: wp
  use parcels, only: mass_row, spin_row, curvature_row
  use rolling, only: rolling_torques
  implicit none
  private
  public :: sweep_friction, sweep_frictionless

  integer, parameter :: block_pairs = 256   !< listed pairs of a block, which stays in the L1 cache
  real(wp), parameter :: difference(4) = [-1, -1, -1, 1]       !< x, y, z, r or u, v, w, 1/m of a pair
  real(wp), parameter :: reaction(8) = [-1, -1, -1, 1, 1, 1, 1, 1]       !< force and torque on the partner

  !> Touching pairs on their way through the law: both parcels, and the entry of the list.
  type :: selection_t
    integer :: entry = 1                    !< where the selection goes on
    integer :: n = 0                        !< pairs selected
    integer :: place(block_pairs + 1)       !< of each in the block
    integer :: i(block_pairs), j(block_pairs), k(block_pairs)
    real(wp) :: way(4, block_pairs)         !< of all pairs of the block: x_i - x_j, r_i + r_j [m]
  end type selection_t

contains

  !> Add the forces and torques of all pairs that touch, with friction.
  subroutine sweep_friction(law, list, state, force)
    type(contact_law_t), intent(in) :: law
    type(contact_list_t), intent(inout) :: list
    real(wp), intent(in) :: state(16, *)     !< see parcels
    real(wp), intent(inout) :: force(8, *)   !< 1:3 force, 5:7 torque over radius [N]

    type(selection_t) :: chosen
    real(wp) :: pair(8, block_pairs), spin(4, block_pairs), slip(4, block_pairs), forces(8, block_pairs)

    chosen%entry = 1
    do while (chosen%entry <= list%entries)
      call select_pairs(16, state, list, chosen)
      call gather_pairs(16, state, chosen, pair)
      call gather_history(state, list%slip, chosen, spin, slip)
      call friction_forces(law, padded(chosen%n), pair, spin, slip, forces)
      if (law%rolling%on) call roll_pairs(law, list, state, chosen, pair, forces, force)
      call scatter_history(slip, chosen, list%slip)
      call scatter_friction(forces, chosen, force)
    end do
  end subroutine sweep_friction

  !> Add the torques of pairs that resist rolling. The list still has the steps in which they touched last.
  pure subroutine roll_pairs(law, list, state, chosen, pair, forces, force)
    type(contact_law_t), intent(in) :: law
    type(contact_list_t), intent(inout) :: list
    real(wp), intent(in) :: state(16, *)
    type(selection_t), intent(in) :: chosen
    real(wp), intent(in) :: pair(8, block_pairs), forces(8, block_pairs)
    real(wp), intent(inout) :: force(8, *)

    real(wp) :: turn(5, block_pairs), angle(3, block_pairs), torque(3, block_pairs), per_r(2)
    integer :: m, i, j

    do m = 1, chosen%n
      i = chosen%i(m)
      j = chosen%j(m)
      per_r = [state(curvature_row, i), state(curvature_row, j)]
      turn(1:3, m) = per_r(1)*state(spin_row:spin_row + 2, i) - per_r(2)*state(spin_row:spin_row + 2, j)
      turn(4, m) = per_r(1) + per_r(2)
      turn(5, m) = state(mass_row, i)*per_r(1)**2 + state(mass_row, j)*per_r(2)**2
      if (law%rolling%spring) then
        angle(:, m) = merge(list%angle(:, chosen%k(m)), 0.0_wp, list%slip(4, chosen%k(m)) >= law%linear%step - 1.5_wp)
      end if
    end do
    call rolling_torques(law%rolling, law%linear%dt, chosen%n, pair, turn, forces, angle, torque)
    do m = 1, chosen%n
      i = chosen%i(m)
      j = chosen%j(m)
      force(5:7, i) = force(5:7, i) + state(curvature_row, i)*torque(:, m)
      force(5:7, j) = force(5:7, j) - state(curvature_row, j)*torque(:, m)
      if (law%rolling%spring) list%angle(:, chosen%k(m)) = angle(:, m)
    end do
  end subroutine roll_pairs

  !> Add the forces of all pairs that touch, without friction.
  subroutine sweep_frictionless(law, list, state, force)
    type(contact_law_t), intent(in) :: law
    type(contact_list_t), intent(in) :: list
    real(wp), intent(in) :: state(8, *)      !< see parcels
    real(wp), intent(inout) :: force(4, *)   !< 1:3 force [N]

    type(selection_t) :: chosen
    real(wp) :: pair(8, block_pairs), curvature(block_pairs), forces(4, block_pairs)

    chosen%entry = 1
    do while (chosen%entry <= list%entries)
      call select_pairs(8, state, list, chosen)
      call gather_pairs(8, state, chosen, pair)
      if (law%hertzian) call gather_curvature(state, chosen, curvature)
      call frictionless_forces(law, padded(chosen%n), pair, curvature, forces)
      call scatter_frictionless(forces, chosen, force)
    end do
  end subroutine sweep_frictionless

  !> The number of pairs the law is called with.
  pure function padded(n)
    integer, intent(in) :: n
    integer :: padded

    padded = lanes*((n + lanes - 1)/lanes)
  end function padded

  !> Look at the next listed pairs, a block of them, and choose those that touch. In three passes, of which the first
  !> two are vectors: a row of memory at a time, then a row of pairs.
  pure subroutine select_pairs(rows, state, list, chosen)
    integer, intent(in) :: rows              !< of state
    real(wp), intent(in) :: state(rows, *)
    type(contact_list_t), intent(in) :: list
    type(selection_t), intent(inout) :: chosen

    integer :: i, j, l, m, n, before, count
    real(wp) :: gap(block_pairs)

    before = chosen%entry - 1
    count = min(list%entries - before, block_pairs)
    do m = 1, count
      i = list%row(before + m)
      j = list%partner(before + m)
      !$omp simd simdlen(4)
      do l = 1, 4
        chosen%way(l, m) = state(l, i) + difference(l)*state(l, j)
      end do
    end do
    !$omp simd
    do m = 1, count
      gap(m) = chosen%way(1, m)**2 + chosen%way(2, m)**2 + chosen%way(3, m)**2 - chosen%way(4, m)**2
    end do
    n = 0
    do m = 1, count
      chosen%place(n + 1) = m
      n = n + merge(1, 0, gap(m) < 0)
    end do
    do m = 1, n
      chosen%k(m) = before + chosen%place(m)
      chosen%i(m) = list%row(chosen%k(m))
      chosen%j(m) = list%partner(chosen%k(m))
    end do
    chosen%n = n
    chosen%entry = before + count + 1
  end subroutine select_pairs

  !> Differences (position, velocity) and sums (radius, inverse mass) of the pairs. The last lanes, where the
  !> law is called with more pairs than there are, repeat the last pair.
  pure subroutine gather_pairs(rows, state, chosen, pair)
    integer, intent(in) :: rows
    real(wp), intent(in) :: state(rows, *)
    type(selection_t), intent(in) :: chosen
    real(wp), intent(inout) :: pair(8, block_pairs)

    integer :: m, l, i, j

    do m = 1, chosen%n
      i = chosen%i(m)
      j = chosen%j(m)
      !$omp simd simdlen(4)
      do l = 1, 4
        pair(l, m) = chosen%way(l, chosen%place(m))
        pair(l + 4, m) = state(l + 4, i) + difference(l)*state(l + 4, j)
      end do
    end do
    do m = chosen%n + 1, padded(chosen%n)
      pair(:, m) = pair(:, chosen%n)
    end do
  end subroutine gather_pairs

  pure subroutine gather_history(state, history, chosen, spin, slip)
    real(wp), intent(in) :: state(16, *)
    real(wp), intent(in) :: history(4, *)
    type(selection_t), intent(in) :: chosen
    real(wp), intent(inout) :: spin(4, block_pairs), slip(4, block_pairs)

    integer :: m, l, i, j, k

    do m = 1, chosen%n
      i = chosen%i(m)
      j = chosen%j(m)
      k = chosen%k(m)
      !$omp simd simdlen(4)
      do l = 1, 4
        spin(l, m) = state(8 + l, i) + state(8 + l, j)
        slip(l, m) = history(l, k)
      end do
    end do
    do m = chosen%n + 1, padded(chosen%n)
      spin(:, m) = spin(:, chosen%n)
      slip(:, m) = 0.0_wp
    end do
  end subroutine gather_history

  !> 1/r_i + 1/r_j where the state has no row for it.
  pure subroutine gather_curvature(state, chosen, curvature)
    real(wp), intent(in) :: state(8, *)
    type(selection_t), intent(in) :: chosen
    real(wp), intent(inout) :: curvature(block_pairs)

    integer :: m

    do m = 1, chosen%n
      curvature(m) = 1/state(4, chosen%i(m)) + 1/state(4, chosen%j(m))
    end do
    curvature(chosen%n + 1:padded(chosen%n)) = curvature(max(chosen%n, 1))
  end subroutine gather_curvature

  pure subroutine scatter_history(slip, chosen, history)
    real(wp), intent(in) :: slip(4, block_pairs)
    type(selection_t), intent(in) :: chosen
    real(wp), intent(inout) :: history(4, *)

    integer :: m, l, k

    do m = 1, chosen%n
      k = chosen%k(m)
      !$omp simd simdlen(4)
      do l = 1, 4
        history(l, k) = slip(l, m)
      end do
    end do
  end subroutine scatter_history

  !> Force and torque on both parcels of every pair.
  pure subroutine scatter_friction(forces, chosen, force)
    real(wp), intent(in) :: forces(8, block_pairs)
    type(selection_t), intent(in) :: chosen
    real(wp), intent(inout) :: force(8, *)

    integer :: m, l, i, j

    do m = 1, chosen%n
      i = chosen%i(m)
      j = chosen%j(m)
      !$omp simd simdlen(8)
      do l = 1, 8
        force(l, i) = force(l, i) + forces(l, m)
      end do
      !$omp simd simdlen(8)
      do l = 1, 8
        force(l, j) = force(l, j) + reaction(l)*forces(l, m)
      end do
    end do
  end subroutine scatter_friction

  pure subroutine scatter_frictionless(forces, chosen, force)
    real(wp), intent(in) :: forces(4, block_pairs)
    type(selection_t), intent(in) :: chosen
    real(wp), intent(inout) :: force(4, *)

    integer :: m, l, i, j

    do m = 1, chosen%n
      i = chosen%i(m)
      j = chosen%j(m)
      !$omp simd simdlen(4)
      do l = 1, 4
        force(l, i) = force(l, i) + forces(l, m)
      end do
      !$omp simd simdlen(4)
      do l = 1, 4
        force(l, j) = force(l, j) - forces(l, m)
      end do
    end do
  end subroutine scatter_frictionless

end module contact_sweep
