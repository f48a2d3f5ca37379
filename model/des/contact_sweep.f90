!> A pass over close pairs, some rows of them at a time: gather a block of pairs, let the law compute their forces eight at a
!> time, and hand the forces out.
!>
!> Where close pairs are tight the law sees them all, and gives no force to those that do not touch. Else half of them do not
!> touch, in no order a processor could foresee; so those that do are selected without a branch, and what is kept of them is
!> written anew, one behind the other.
module contact_sweep
  use close_pairs, only: close_pairs_t, pair_ways
  use contact_lanes, only: lanes, full_lanes, lane_of, group_of, record_rows
  use contact_law, only: contact_law_t, friction_forces, frictionless_forces
  use kinds, only: wp
  use parcels, only: frictional_rows, frictionless_rows, radius_row, mass_row, spin_row, curvature_row, force_place
  use rolling, only: rolling_torques
  implicit none
  private
  public :: sweep_friction, sweep_frictionless

  integer, parameter :: block_pairs = 128   !< pairs of a block, which stays in the L1 cache; a multiple of lanes
  real(wp), parameter :: difference(4) = [-1, -1, -1, 1]       !< x, y, z, r or u, v, w, 1/m of a pair
  real(wp), parameter :: reaction(8) = [-1, -1, -1, 1, 1, 1, 1, 1]       !< force and torque on the partner

contains

  !> Add the forces and torques of the pairs that touch, with friction.
  subroutine sweep_friction(law, pairs, last, state, ring, force)
    type(contact_law_t), intent(in) :: law
    type(close_pairs_t), intent(inout) :: pairs
    integer, intent(in) :: last                       !< pair; those up to `pairs%swept` are done
    real(wp), intent(in) :: state(frictional_rows, *)  !< see parcels
    integer, intent(in) :: ring(2)                    !< see force_place: own parcels, columns of force
    real(wp), intent(inout) :: force(8, 0:*)            !< 1:3 force, 5:7 torque over radius [N]

    integer :: first, next

    first = pairs%swept + 1
    do while (first <= last)
      next = min(first + block_pairs, last + 1)
      if (pairs%tight) then
        call sweep_tight(law, pairs, first, next - first, state, ring, force)
      else
        call sweep_loose(law, pairs, first, next - first, state, ring, force)
      end if
      first = next
    end do
  end subroutine sweep_friction

  !> A block of tight pairs, whose records are used in place.
  subroutine sweep_tight(law, pairs, first, n, state, ring, force)
    type(contact_law_t), intent(in) :: law
    type(close_pairs_t), intent(inout) :: pairs
    integer, intent(in) :: first, n                   !< pairs
    real(wp), intent(in) :: state(frictional_rows, *)
    integer, intent(in) :: ring(2)                    !< see force_place: own parcels, columns of force
    real(wp), intent(inout) :: force(8, 0:*)

    real(wp) :: pair(8, block_pairs), spin(4, block_pairs), angle(3, block_pairs)

    associate (i => pairs%i(first:first + n - 1), j => pairs%j(first:first + n - 1), &
               record => pairs%record(:, :, group_of(first):))
      call gather_friction(n, i, j, state, pair, spin)
      if (pairs%with_angles) then
        call add_friction(law, n, i, j, state, pair, spin, record, pairs%angle(:, first:), ring, force)
      else
        call add_friction(law, n, i, j, state, pair, spin, record, angle, ring, force)
      end if
    end associate
  end subroutine sweep_tight

  !> Those of a block of pairs that touch, with the memories of the step before.
  subroutine sweep_loose(law, pairs, first, count, state, ring, force)
    type(contact_law_t), intent(in) :: law
    type(close_pairs_t), intent(inout) :: pairs
    integer, intent(in) :: first, count               !< pairs
    real(wp), intent(in) :: state(frictional_rows, *)
    integer, intent(in) :: ring(2)                    !< see force_place: own parcels, columns of force
    real(wp), intent(inout) :: force(8, 0:*)

    real(wp) :: pair(8, block_pairs), spin(4, block_pairs), angle(3, block_pairs)
    real(wp) :: record(lanes, record_rows, block_pairs/lanes)
    integer :: i(block_pairs), j(block_pairs), place(block_pairs), n, m

    call select_pairs(frictional_rows, state, pairs, first, count, n, i, j, place)
    call gather_friction(n, i, j, state, pair, spin)
    place(n + 1:full_lanes(n)) = 0
    do m = 1, full_lanes(n)
      associate (l => lane_of(m), g => group_of(m))
        record(l, 1:3, g) = pairs%before(1:3, place(m))
        record(l, 4, g) = 1/sqrt(pair(8, m))
        record(l, 5, g) = 1/pair(4, m)
      end associate
      if (pairs%with_angles) angle(:, m) = pairs%before(4:6, place(m))
    end do
    call add_friction(law, n, i, j, state, pair, spin, record, angle, ring, force)
    call pairs%make_room(pairs%memories + n)
    do m = 1, n
      pairs%memory(1:3, pairs%memories + m) = record(lane_of(m), 1:3, group_of(m))
      if (pairs%with_angles) pairs%memory(4:6, pairs%memories + m) = angle(:, m)
    end do
    pairs%memories = pairs%memories + n
  end subroutine sweep_loose

  !> What a block of pairs adds.
  pure subroutine add_friction(law, n, i, j, state, pair, spin, record, angle, ring, force)
    type(contact_law_t), intent(in) :: law
    integer, intent(in) :: n, i(n), j(n)               !< columns
    real(wp), intent(in) :: state(frictional_rows, *)
    real(wp), intent(in) :: pair(8, block_pairs), spin(4, block_pairs)  !< see gather_friction
    real(wp), intent(inout) :: record(lanes, record_rows, *)  !< see contact_lanes
    real(wp), intent(inout) :: angle(3, *)             !< with rolling springs
    integer, intent(in) :: ring(2)                    !< see force_place: own parcels, columns of force
    real(wp), intent(inout) :: force(8, 0:*)

    real(wp) :: forces(8, block_pairs), torque(3, block_pairs)

    call friction_forces(law, full_lanes(n), pair, spin, record, forces)
    if (law%rolling%on) then
      call roll_pairs(law, n, i, j, state, pair, forces, angle, torque)
      call scatter_rolling(n, i, j, state, forces, torque, ring, force)
    else
      call scatter_friction(n, i, j, forces, ring, force)
    end if
  end subroutine add_friction

  !> Torques of pairs that resist rolling.
  pure subroutine roll_pairs(law, n, i, j, state, pair, forces, angle, torque)
    type(contact_law_t), intent(in) :: law
    integer, intent(in) :: n, i(n), j(n)
    real(wp), intent(in) :: state(frictional_rows, *)
    real(wp), intent(in) :: pair(8, block_pairs), forces(8, block_pairs)
    real(wp), intent(inout) :: angle(3, *)
    real(wp), intent(inout) :: torque(3, block_pairs)

    real(wp) :: turn(5, block_pairs), push(3, block_pairs), per_r(2)
    integer :: m

    do m = 1, n
      per_r = [state(curvature_row, i(m)), state(curvature_row, j(m))]
      turn(1:3, m) = per_r(1)*state(spin_row:spin_row + 2, i(m)) - per_r(2)*state(spin_row:spin_row + 2, j(m))
      turn(4, m) = per_r(1) + per_r(2)
      turn(5, m) = state(mass_row, i(m))*per_r(1)**2 + state(mass_row, j(m))*per_r(2)**2
      push(:, m) = forces(1:3, m)
    end do
    do m = n + 1, full_lanes(n)
      turn(:, m) = turn(:, n)
      push(:, m) = 0.0_wp
      angle(:, m) = 0.0_wp
    end do
    call rolling_torques(law%rolling, law%linear%dt, full_lanes(n), pair, turn, push, angle, torque)
  end subroutine roll_pairs

  !> As `scatter_friction`, with the torques against rolling, which are opposite on the two. What a pair does is added at once,
  !> so that sums do not depend on where blocks end.
  pure subroutine scatter_rolling(n, i, j, state, forces, torque, ring, force)
    integer, intent(in) :: n, i(n), j(n)
    real(wp), intent(in) :: state(frictional_rows, *)
    real(wp), intent(in) :: forces(8, block_pairs), torque(3, block_pairs)
    integer, intent(in) :: ring(2)                    !< see force_place: own parcels, columns of force
    real(wp), intent(inout) :: force(8, 0:*)

    real(wp) :: share(8)
    integer :: m, a, b

    do m = 1, n
      share = forces(:, m)
      share(5:7) = share(5:7) + state(curvature_row, i(m))*torque(:, m)
      a = force_place(i(m), ring(1), ring(2))
      force(1:8, a) = force(1:8, a) + share
      share = reaction*forces(:, m)
      share(5:7) = share(5:7) - state(curvature_row, j(m))*torque(:, m)
      b = force_place(j(m), ring(1), ring(2))
      force(1:8, b) = force(1:8, b) + share
    end do
  end subroutine scatter_rolling

  !> Add the forces of the pairs that touch, without friction.
  subroutine sweep_frictionless(law, pairs, last, state, ring, force)
    type(contact_law_t), intent(in) :: law
    type(close_pairs_t), intent(inout) :: pairs
    integer, intent(in) :: last              !< pair; those up to `pairs%swept` are done
    real(wp), intent(in) :: state(frictionless_rows, *)  !< see parcels
    integer, intent(in) :: ring(2)           !< see force_place: own parcels, columns of force
    real(wp), intent(inout) :: force(4, 0:*)   !< 1:3 force [N]

    integer :: i(block_pairs), j(block_pairs), place(block_pairs), first, next, n

    first = pairs%swept + 1
    do while (first <= last)
      next = min(first + block_pairs, last + 1)
      if (pairs%tight) then
        call add_frictionless(law, next - first, pairs%i(first:next - 1), pairs%j(first:next - 1), state, ring, force)
      else
        call select_pairs(frictionless_rows, state, pairs, first, next - first, n, i, j, place)
        call add_frictionless(law, n, i, j, state, ring, force)
      end if
      first = next
    end do
  end subroutine sweep_frictionless

  !> What a block of pairs adds.
  pure subroutine add_frictionless(law, n, i, j, state, ring, force)
    type(contact_law_t), intent(in) :: law
    integer, intent(in) :: n, i(n), j(n)               !< columns
    real(wp), intent(in) :: state(frictionless_rows, *)
    integer, intent(in) :: ring(2)           !< see force_place: own parcels, columns of force
    real(wp), intent(inout) :: force(4, 0:*)

    real(wp) :: pair(8, block_pairs), curvature(block_pairs), forces(4, block_pairs)

    call gather_frictionless(n, i, j, state, pair)
    if (law%hertzian) call gather_curvature(n, i, j, state, curvature)
    call frictionless_forces(law, full_lanes(n), pair, curvature, forces)
    call scatter_frictionless(n, i, j, forces, ring, force)
  end subroutine add_frictionless

  !> Of a block of pairs, those that touch. In passes, of which the first two are vectors: a row of memory at a time, then a row
  !> of pairs.
  pure subroutine select_pairs(rows, state, pairs, first, count, n, i, j, place)
    integer, intent(in) :: rows              !< of state
    real(wp), intent(in) :: state(rows, *)
    type(close_pairs_t), intent(inout) :: pairs
    integer, intent(in) :: first, count      !< pairs looked at
    integer, intent(out) :: n                !< pairs that touch
    integer, intent(inout) :: i(block_pairs), j(block_pairs)  !< columns
    integer, intent(inout) :: place(block_pairs)  !< of their memories of the step before, with friction

    integer :: m, found, touching(block_pairs), pair(block_pairs)
    real(wp) :: way(4, block_pairs)

    call pair_ways(rows, state, count, pairs%i(first:), pairs%j(first:), way)
    !$omp simd
    do m = 1, count
      touching(m) = merge(1, 0, way(1, m)**2 + way(2, m)**2 + way(3, m)**2 - way(4, m)**2 < 0.0_wp)
    end do
    found = 0
    do m = 1, count
      pair(found + 1) = first + m - 1
      found = found + touching(m)
    end do
    n = found
    do m = 1, n
      i(m) = pairs%i(pair(m))
      j(m) = pairs%j(pair(m))
    end do
    if (.not. pairs%with_history) return
    do m = 1, n
      place(m) = pairs%place(pair(m))
    end do
    pairs%place(first:first + count - 1) = 0
    do m = 1, n
      pairs%place(pair(m)) = pairs%memories + m
    end do
  end subroutine select_pairs

  !> Differences (position, velocity) and sums (radius, inverse mass, spin) of the pairs. The last lanes, where the
  !> law is called with more pairs than there are, repeat the last pair.
  pure subroutine gather_friction(n, i, j, state, pair, spin)
    integer, intent(in) :: n, i(n), j(n)
    real(wp), intent(in) :: state(frictional_rows, *)
    real(wp), intent(inout) :: pair(8, block_pairs), spin(4, block_pairs)

    integer :: m, l

    do m = 1, n
      !$omp simd simdlen(4)
      do l = 1, 4
        pair(l, m) = state(l, i(m)) + difference(l)*state(l, j(m))
        pair(l + 4, m) = state(l + 4, i(m)) + difference(l)*state(l + 4, j(m))
        spin(l, m) = state(l + 8, i(m)) + state(l + 8, j(m))
      end do
    end do
    do m = n + 1, full_lanes(n)
      pair(:, m) = pair(:, n)
      spin(:, m) = spin(:, n)
    end do
  end subroutine gather_friction

  !> The same without spin.
  pure subroutine gather_frictionless(n, i, j, state, pair)
    integer, intent(in) :: n, i(n), j(n)
    real(wp), intent(in) :: state(frictionless_rows, *)
    real(wp), intent(inout) :: pair(8, block_pairs)

    integer :: m, l

    do m = 1, n
      !$omp simd simdlen(4)
      do l = 1, 4
        pair(l, m) = state(l, i(m)) + difference(l)*state(l, j(m))
        pair(l + 4, m) = state(l + 4, i(m)) + difference(l)*state(l + 4, j(m))
      end do
    end do
    do m = n + 1, full_lanes(n)
      pair(:, m) = pair(:, n)
    end do
  end subroutine gather_frictionless

  !> 1/r_i + 1/r_j where the state has no row for it.
  pure subroutine gather_curvature(n, i, j, state, curvature)
    integer, intent(in) :: n, i(n), j(n)
    real(wp), intent(in) :: state(frictionless_rows, *)
    real(wp), intent(inout) :: curvature(block_pairs)

    integer :: m

    do m = 1, n
      curvature(m) = 1/state(radius_row, i(m)) + 1/state(radius_row, j(m))
    end do
    curvature(n + 1:full_lanes(n)) = curvature(max(n, 1))
  end subroutine gather_curvature

  !> Force and torque on both parcels of every pair.
  pure subroutine scatter_friction(n, i, j, forces, ring, force)
    integer, intent(in) :: n, i(n), j(n)
    real(wp), intent(in) :: forces(8, block_pairs)
    integer, intent(in) :: ring(2)                    !< see force_place: own parcels, columns of force
    real(wp), intent(inout) :: force(8, 0:*)

    integer :: m, l, a, b

    do m = 1, n
      a = force_place(i(m), ring(1), ring(2))
      b = force_place(j(m), ring(1), ring(2))
      !$omp simd simdlen(8)
      do l = 1, 8
        force(l, a) = force(l, a) + forces(l, m)
      end do
      !$omp simd simdlen(8)
      do l = 1, 8
        force(l, b) = force(l, b) + reaction(l)*forces(l, m)
      end do
    end do
  end subroutine scatter_friction

  pure subroutine scatter_frictionless(n, i, j, forces, ring, force)
    integer, intent(in) :: n, i(n), j(n)
    real(wp), intent(in) :: forces(4, block_pairs)
    integer, intent(in) :: ring(2)           !< see force_place: own parcels, columns of force
    real(wp), intent(inout) :: force(4, 0:*)

    integer :: m, l, a, b

    do m = 1, n
      a = force_place(i(m), ring(1), ring(2))
      b = force_place(j(m), ring(1), ring(2))
      !$omp simd simdlen(4)
      do l = 1, 4
        force(l, a) = force(l, a) + forces(l, m)
      end do
      !$omp simd simdlen(4)
      do l = 1, 4
        force(l, b) = force(l, b) - forces(l, m)
      end do
    end do
  end subroutine scatter_frictionless

end module contact_sweep
