!> A pass over close pairs, some rows of them at a time: gather a block of pairs, let the law compute their forces eight at a
!> time, and hand the forces out.
!>
!> Where close pairs are tight the law sees them all, and what it says of pairs that do not touch counts nothing. Else half of
!> them do not touch, in no order a processor could foresee; so those that do are selected without a branch.
module contact_sweep
  use close_pairs, only: close_pairs_t, pair_ways, never
  use contact_lanes, only: lanes
  use contact_law, only: contact_law_t, friction_forces, frictionless_forces
  use kinds, only: wp
  use parcels, only: frictional_rows, mass_row, spin_row, curvature_row
  use rolling, only: rolling_torques
  implicit none
  private
  public :: sweep_friction, sweep_frictionless

  integer, parameter :: block_pairs = 128   !< pairs of a block, which stays in the L1 cache; a multiple of lanes
  real(wp), parameter :: difference(4) = [-1, -1, -1, 1]       !< x, y, z, r or u, v, w, 1/m of a pair
  real(wp), parameter :: reaction(8) = [-1, -1, -1, 1, 1, 1, 1, 1]       !< force and torque on the partner

  !> A block of pairs on its way through the law.
  type :: block_t
    integer :: n                         !< pairs
    integer :: i(block_pairs), j(block_pairs)
    integer :: k(block_pairs)            !< place among the close pairs
    real(wp) :: pair(8, block_pairs)     !< see contact_law
    real(wp) :: touch(block_pairs)       !< 1 where the two touch, else 0
  end type block_t

contains

  !> Add the forces and torques of the pairs that touch, with friction.
  subroutine sweep_friction(law, pairs, last, state, force)
    type(contact_law_t), intent(in) :: law
    type(close_pairs_t), intent(inout) :: pairs
    integer, intent(in) :: last                           !< pair; those up to `pairs%swept` are done
    real(wp), intent(in) :: state(frictional_rows, *)     !< see parcels
    real(wp), intent(inout) :: force(8, *)   !< 1:3 force, 5:7 torque over radius [N]

    type(block_t) :: block
    real(wp) :: spin(4, block_pairs), slip(4, block_pairs), angle(3, block_pairs), torque(3, block_pairs)
    real(wp) :: forces(8, block_pairs)
    integer :: next

    next = pairs%swept + 1
    do while (next <= last)
      if (pairs%tight) then
        call take_block(pairs, next, last, block)
        call gather_pairs(frictional_rows, state, block)
        call gather_spins(state, block, spin)
        if (law%rolling%spring) call gather_angles(law, pairs, next, block, angle)
        associate (slips => pairs%slip(:, next:next + padded(block%n) - 1))
          call friction_forces(law, padded(block%n), block%pair, spin, slips, forces)
          call unmark(block, slips)
        end associate
        next = next + block%n
      else
        call select_pairs(frictional_rows, state, pairs, next, last, block)
        call gather_pairs(frictional_rows, state, block)
        call gather_spins(state, block, spin)
        call gather_slips(pairs%slip, block, slip)
        if (law%rolling%spring) call gather_angles(law, pairs, 0, block, angle)
        call friction_forces(law, padded(block%n), block%pair, spin, slip, forces)
        call scatter_slips(slip, block, pairs%slip)
      end if
      if (law%rolling%on) then
        call roll_pairs(law, state, block, forces, angle, torque)
        call scatter_rolling(state, forces, torque, block, force)
        if (law%rolling%spring) call scatter_angles(angle, block, pairs%angle)
      else
        call scatter_friction(forces, block, force)
      end if
    end do
  end subroutine sweep_friction

  !> How far the pairs have rolled, before the law marks that they touch.
  pure subroutine gather_angles(law, pairs, first, block, angle)
    type(contact_law_t), intent(in) :: law
    type(close_pairs_t), intent(in) :: pairs
    integer, intent(in) :: first            !< place of the block; 0: its places are known
    type(block_t), intent(inout) :: block
    real(wp), intent(inout) :: angle(3, block_pairs)

    integer :: m, k

    do m = 1, block%n
      if (first > 0) block%k(m) = first + m - 1
      k = block%k(m)
      angle(:, m) = merge(pairs%angle(:, k), 0.0_wp, pairs%slip(4, k) >= law%linear%step - 1.5_wp)
    end do
  end subroutine gather_angles

  !> Torques of pairs that resist rolling.
  pure subroutine roll_pairs(law, state, block, forces, angle, torque)
    type(contact_law_t), intent(in) :: law
    real(wp), intent(in) :: state(frictional_rows, *)
    type(block_t), intent(in) :: block
    real(wp), intent(in) :: forces(8, block_pairs)
    real(wp), intent(inout) :: angle(3, block_pairs), torque(3, block_pairs)

    real(wp) :: turn(5, block_pairs), push(3, block_pairs), per_r(2)
    integer :: m, i, j

    do m = 1, block%n
      i = block%i(m)
      j = block%j(m)
      per_r = [state(curvature_row, i), state(curvature_row, j)]
      turn(1:3, m) = per_r(1)*state(spin_row:spin_row + 2, i) - per_r(2)*state(spin_row:spin_row + 2, j)
      turn(4, m) = per_r(1) + per_r(2)
      turn(5, m) = state(mass_row, i)*per_r(1)**2 + state(mass_row, j)*per_r(2)**2
      push(:, m) = block%touch(m)*forces(1:3, m)
    end do
    do m = block%n + 1, padded(block%n)
      turn(:, m) = turn(:, block%n)
      push(:, m) = 0.0_wp
      angle(:, m) = 0.0_wp
    end do
    call rolling_torques(law%rolling, law%linear%dt, padded(block%n), block%pair, turn, push, angle, torque)
  end subroutine roll_pairs

  !> As `scatter_friction`, with the torques against rolling, which are opposite on the two. What a pair does is added at once,
  !> so that sums do not depend on where blocks end.
  pure subroutine scatter_rolling(state, forces, torque, block, force)
    real(wp), intent(in) :: state(frictional_rows, *)
    real(wp), intent(in) :: forces(8, block_pairs), torque(3, block_pairs)
    type(block_t), intent(in) :: block
    real(wp), intent(inout) :: force(8, *)

    real(wp) :: share(8)
    integer :: m, i, j

    do m = 1, block%n
      i = block%i(m)
      j = block%j(m)
      share = block%touch(m)*forces(:, m)
      share(5:7) = share(5:7) + state(curvature_row, i)*torque(:, m)
      force(1:8, i) = force(1:8, i) + share
      share = block%touch(m)*reaction*forces(:, m)
      share(5:7) = share(5:7) - state(curvature_row, j)*torque(:, m)
      force(1:8, j) = force(1:8, j) + share
    end do
  end subroutine scatter_rolling

  !> Those of pairs that do not touch count nothing, as their slips have no mark.
  pure subroutine scatter_angles(angle, block, angles)
    real(wp), intent(in) :: angle(3, block_pairs)
    type(block_t), intent(in) :: block
    real(wp), intent(inout) :: angles(3, *)

    integer :: m

    do m = 1, block%n
      angles(:, block%k(m)) = angle(:, m)
    end do
  end subroutine scatter_angles

  !> Add the forces of the pairs that touch, without friction.
  subroutine sweep_frictionless(law, pairs, last, state, force)
    type(contact_law_t), intent(in) :: law
    type(close_pairs_t), intent(in) :: pairs
    integer, intent(in) :: last              !< pair; those up to `pairs%swept` are done
    real(wp), intent(in) :: state(8, *)      !< see parcels
    real(wp), intent(inout) :: force(4, *)   !< 1:3 force [N]

    type(block_t) :: block
    real(wp) :: curvature(block_pairs), forces(4, block_pairs)
    integer :: next

    next = pairs%swept + 1
    do while (next <= last)
      if (pairs%tight) then
        call take_block(pairs, next, last, block)
        next = next + block%n
      else
        call select_pairs(8, state, pairs, next, last, block)
      end if
      call gather_pairs(8, state, block)
      if (law%hertzian) call gather_curvature(state, block, curvature)
      call frictionless_forces(law, padded(block%n), block%pair, curvature, forces)
      call scatter_frictionless(forces, block, force)
    end do
  end subroutine sweep_frictionless

  !> The number of pairs the law is called with.
  pure function padded(n)
    integer, intent(in) :: n
    integer :: padded

    padded = lanes*((n + lanes - 1)/lanes)
  end function padded

  !> The next pairs as they come.
  pure subroutine take_block(pairs, next, last, block)
    type(close_pairs_t), intent(in) :: pairs
    integer, intent(in) :: next, last
    type(block_t), intent(inout) :: block

    integer :: n

    n = min(last - next + 1, block_pairs)
    block%n = n
    block%i(1:n) = pairs%i(next:next + n - 1)
    block%j(1:n) = pairs%j(next:next + n - 1)
  end subroutine take_block

  !> Of the next pairs, a block of them, those that touch. In three passes, of which the first two are vectors: a row of
  !> memory at a time, then a row of pairs.
  pure subroutine select_pairs(rows, state, pairs, next, last, block)
    integer, intent(in) :: rows              !< of state
    real(wp), intent(in) :: state(rows, *)
    type(close_pairs_t), intent(in) :: pairs
    integer, intent(inout) :: next           !< pair to go on with
    integer, intent(in) :: last
    type(block_t), intent(inout) :: block

    integer :: m, n, count
    real(wp) :: way(4, block_pairs), gap(block_pairs)

    count = min(last - next + 1, block_pairs)
    call pair_ways(rows, state, count, pairs%i(next:), pairs%j(next:), way)
    !$omp simd
    do m = 1, count
      gap(m) = way(1, m)**2 + way(2, m)**2 + way(3, m)**2 - way(4, m)**2
    end do
    n = 0
    do m = 1, count
      block%k(n + 1) = next + m - 1
      n = n + merge(1, 0, gap(m) < 0)
    end do
    do m = 1, n
      block%i(m) = pairs%i(block%k(m))
      block%j(m) = pairs%j(block%k(m))
    end do
    block%n = n
    next = next + count
  end subroutine select_pairs

  !> Differences (position, velocity) and sums (radius, inverse mass) of the pairs. The last lanes, where the
  !> law is called with more pairs than there are, repeat the last pair.
  pure subroutine gather_pairs(rows, state, block)
    integer, intent(in) :: rows
    real(wp), intent(in) :: state(rows, *)
    type(block_t), intent(inout) :: block

    integer :: m, l, i, j

    do m = 1, block%n
      i = block%i(m)
      j = block%j(m)
      !$omp simd simdlen(4)
      do l = 1, 4
        block%pair(l, m) = state(l, i) + difference(l)*state(l, j)
        block%pair(l + 4, m) = state(l + 4, i) + difference(l)*state(l + 4, j)
      end do
    end do
    do m = block%n + 1, padded(block%n)
      block%pair(:, m) = block%pair(:, block%n)
    end do
    associate (pair => block%pair)
      !$omp simd
      do m = 1, block%n
        block%touch(m) = merge(1.0_wp, 0.0_wp, pair(1, m)**2 + pair(2, m)**2 + pair(3, m)**2 < pair(4, m)**2)
      end do
    end associate
  end subroutine gather_pairs

  pure subroutine gather_spins(state, block, spin)
    real(wp), intent(in) :: state(frictional_rows, *)
    type(block_t), intent(in) :: block
    real(wp), intent(inout) :: spin(4, block_pairs)

    integer :: m, l

    do m = 1, block%n
      !$omp simd simdlen(4)
      do l = 1, 4
        spin(l, m) = state(8 + l, block%i(m)) + state(8 + l, block%j(m))
      end do
    end do
    do m = block%n + 1, padded(block%n)
      spin(:, m) = spin(:, block%n)
    end do
  end subroutine gather_spins

  pure subroutine gather_slips(slips, block, slip)
    real(wp), intent(in) :: slips(4, *)
    type(block_t), intent(in) :: block
    real(wp), intent(inout) :: slip(4, block_pairs)

    integer :: m

    do m = 1, block%n
      slip(:, m) = slips(:, block%k(m))
    end do
    do m = block%n + 1, padded(block%n)
      slip(:, m) = 0.0_wp
    end do
  end subroutine gather_slips

  !> Pairs that do not touch have no slip.
  pure subroutine unmark(block, slip)
    type(block_t), intent(in) :: block
    real(wp), intent(inout) :: slip(4, *)

    integer :: m

    do m = 1, block%n
      slip(4, m) = merge(slip(4, m), never, block%touch(m) > 0)
    end do
  end subroutine unmark

  !> 1/r_i + 1/r_j where the state has no row for it.
  pure subroutine gather_curvature(state, block, curvature)
    real(wp), intent(in) :: state(8, *)
    type(block_t), intent(in) :: block
    real(wp), intent(inout) :: curvature(block_pairs)

    integer :: m

    do m = 1, block%n
      curvature(m) = 1/state(4, block%i(m)) + 1/state(4, block%j(m))
    end do
    curvature(block%n + 1:padded(block%n)) = curvature(max(block%n, 1))
  end subroutine gather_curvature

  pure subroutine scatter_slips(slip, block, slips)
    real(wp), intent(in) :: slip(4, block_pairs)
    type(block_t), intent(in) :: block
    real(wp), intent(inout) :: slips(4, *)

    integer :: m, l, k

    do m = 1, block%n
      k = block%k(m)
      !$omp simd simdlen(4)
      do l = 1, 4
        slips(l, k) = slip(l, m)
      end do
    end do
  end subroutine scatter_slips

  !> Force and torque on both parcels of every pair.
  pure subroutine scatter_friction(forces, block, force)
    real(wp), intent(in) :: forces(8, block_pairs)
    type(block_t), intent(in) :: block
    real(wp), intent(inout) :: force(8, *)

    integer :: m, l, i, j

    do m = 1, block%n
      i = block%i(m)
      j = block%j(m)
      !$omp simd simdlen(8)
      do l = 1, 8
        force(l, i) = force(l, i) + block%touch(m)*forces(l, m)
      end do
      !$omp simd simdlen(8)
      do l = 1, 8
        force(l, j) = force(l, j) + block%touch(m)*reaction(l)*forces(l, m)
      end do
    end do
  end subroutine scatter_friction

  pure subroutine scatter_frictionless(forces, block, force)
    real(wp), intent(in) :: forces(4, block_pairs)
    type(block_t), intent(in) :: block
    real(wp), intent(inout) :: force(4, *)

    integer :: m, l, i, j

    do m = 1, block%n
      i = block%i(m)
      j = block%j(m)
      !$omp simd simdlen(4)
      do l = 1, 4
        force(l, i) = force(l, i) + block%touch(m)*forces(l, m)
      end do
      !$omp simd simdlen(4)
      do l = 1, 4
        force(l, j) = force(l, j) - block%touch(m)*forces(l, m)
      end do
    end do
  end subroutine scatter_frictionless

end module contact_sweep
