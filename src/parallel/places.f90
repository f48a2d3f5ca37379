!> Tiles of a block: their places in it, which lie side by side, and the work of those of a part.
module places
  use kinds, only: wp
  implicit none
  private
  public :: place_in_block, vertex_at, beside, loads

contains

  !> The vertex, from 0, next to a place in direction a; -1 if there is none.
  !> Two tiles joined on both sides are neighbours once, a single one is not its own neighbour.
  pure function beside(n, periodic, place, a, side) result(vertex)
    integer, intent(in) :: n(3), place(3), a, side
    logical, intent(in) :: periodic(3)
    integer :: vertex

    integer :: at(3)

    at = place
    at(a) = place(a) + side
    vertex = -1
    if (at(a) < 0 .or. at(a) >= n(a)) then
      if (.not. periodic(a) .or. n(a) < 3) return
      at(a) = modulo(at(a), n(a))
    end if
    vertex = vertex_at(n, at)
  end function beside

  !> Place of a vertex of a block, all from 0.
  pure function place_in_block(n, vertex) result(place)
    integer, intent(in) :: n(3), vertex
    integer :: place(3)

    place = [modulo(vertex, n(1)), modulo(vertex/n(1), n(2)), vertex/(n(1)*n(2))]
  end function place_in_block

  !> The vertex at a place of a block, all from 0.
  pure function vertex_at(n, place) result(vertex)
    integer, intent(in) :: n(3), place(3)
    integer :: vertex

    vertex = place(1) + n(1)*(place(2) + n(2)*place(3))
  end function vertex_at

  !> Work of each kind of each part.
  pure function loads(parts, work, part) result(load)
    integer, intent(in) :: parts
    real(wp), intent(in) :: work(:,:)  !< (kinds, tiles)
    integer, intent(in) :: part(:)     !< (tiles) from 0
    real(wp) :: load(size(work, 1), 0:parts - 1)

    integer :: v

    load = 0
    do v = 1, size(part)
      load(:, part(v)) = load(:, part(v)) + work(:, v)
    end do
  end function loads

end module places
