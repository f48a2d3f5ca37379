!> Tiles handed over at the borders between ranks, so that work which wanders is followed without cutting the block anew.
!>
!> A tile goes to a neighbour that has less to do, if that saves more time than the border that grows costs: parcels on both
!> sides of it are copied, listed and touched on both ranks. So borders stay flat.
module handover
  use kinds, only: wp
  use places, only: place_in_block, vertex_at, beside, loads
  implicit none
  private
  public :: hand_over

  real(wp), parameter :: border_cost = 0.45_wp  !< of a face between two ranks, over the work of a tile beside it
  integer, parameter :: most_rounds = 12
  real(wp), parameter :: least_gain(3) = [0.6_wp, 0.3_wp, 0.05_wp]  !< over the work of a tile: the best moves come first

contains

  !> Improve the parts of an n(1) x n(2) x n(3) block, x fastest.
  subroutine hand_over(n, periodic, area, work, parts, part)
    integer, intent(in) :: n(3)
    logical, intent(in) :: periodic(3)
    real(wp), intent(in) :: area(3)     !< face of a tile across each direction [any unit]
    real(wp), intent(in) :: work(:,:)   !< (kinds, tiles) [any unit], see partition
    integer, intent(in) :: parts
    integer, intent(inout) :: part(:)   !< (tiles) from 0

    real(wp) :: load(size(work, 1), 0:parts - 1), whole(size(part))
    integer :: round, v, turn(size(part)), k
    logical :: changed

    load = loads(parts, work, part)
    whole = sum(work, 1)
    turn = shortest_first(n)
    do round = 1, most_rounds
      changed = .false.
      do k = 1, size(part)
        v = turn(k)
        if (whole(v) > 0) call move(v, least_gain(min(round, size(least_gain)))*whole(v))
      end do
      if (.not. changed .and. round >= size(least_gain)) exit
    end do

  contains

    !> A tile goes where it gains most, if that is enough.
    subroutine move(v, enough)
      integer, intent(in) :: v
      real(wp), intent(in) :: enough

      real(wp) :: gain, best
      integer :: beyond(6), side, from, to

      from = part(v)
      if (all(load(:, from) <= work(:, v))) return  ! nobody gives its last
      beyond = neighbours(n, periodic, v)
      best = enough
      to = from
      do side = 1, 6
        if (beyond(side) == 0) cycle
        if (part(beyond(side)) == from) cycle
        gain = time_saved(load(:, from), load(:, part(beyond(side))), work(:, v)) &
               - border_cost*growth(area, whole, part, v, beyond, part(beyond(side)))
        if (gain <= best) cycle
        best = gain
        to = part(beyond(side))
      end do
      if (to == from) return
      load(:, from) = load(:, from) - work(:, v)
      load(:, to) = load(:, to) + work(:, v)
      part(v) = to
      changed = .true.
    end subroutine move

  end subroutine hand_over

  !> All tiles, the shortest direction of the block first: so tiles handed over one after the other lie in rows across the border,
  !> which grows least.
  pure function shortest_first(n) result(turn)
    integer, intent(in) :: n(3)
    integer :: turn(product(n))

    integer :: axis(3), place(3), i, j, k, t

    axis(1) = minloc(n, 1)
    axis(3) = maxloc(n, 1, mask=[1, 2, 3] /= axis(1))
    axis(2) = 6 - axis(1) - axis(3)
    t = 0
    do k = 0, n(axis(3)) - 1
      do j = 0, n(axis(2)) - 1
        do i = 0, n(axis(1)) - 1
          place(axis) = [i, j, k]
          t = t + 1
          turn(t) = 1 + vertex_at(n, place)
        end do
      end do
    end do
  end function shortest_first

  !> Tiles on the lower and upper side in each direction; 0 where there is none.
  pure function neighbours(n, periodic, v) result(beyond)
    integer, intent(in) :: n(3), v
    logical, intent(in) :: periodic(3)
    integer :: beyond(6)

    integer :: a, place(3)

    place = place_in_block(n, v - 1)
    do a = 1, 3
      beyond(2*a - 1) = 1 + beside(n, periodic, place, a, -1)
      beyond(2*a) = 1 + beside(n, periodic, place, a, 1)
    end do
  end function neighbours

  !> By which two parts are ready earlier if a tile goes from one to the other.
  pure function time_saved(giver, taker, work) result(saved)
    real(wp), intent(in) :: giver(:), taker(:)  !< (kinds) their loads
    real(wp), intent(in) :: work(:)             !< (kinds) of the tile
    real(wp) :: saved

    saved = sum(max(giver, taker) - max(giver - work, taker + work))
  end function time_saved

  !> By which the border grows if a tile goes to another part: its faces, each with the mean work on both sides.
  pure function growth(area, whole, part, v, beyond, to)
    real(wp), intent(in) :: area(3), whole(:)
    integer, intent(in) :: part(:), v, beyond(6), to
    real(wp) :: growth

    integer :: a, side

    growth = 0
    do a = 1, 3
      do side = 2*a - 1, 2*a
        if (beyond(side) == 0) cycle
        associate (there => part(beyond(side)))
          growth = growth + area(a)/maxval(area)*0.5_wp*(whole(v) + whole(beyond(side))) &
                   *(merge(1, 0, there /= to) - merge(1, 0, there /= part(v)))
        end associate
      end do
    end do
  end function growth

end module handover
