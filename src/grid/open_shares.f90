!> How much of a cell or a face walls leave open.
!>
!> Where the distance from the walls is positive is found on a lattice in each face, linear between its points; a cell is the
!> sum of slices.
module open_shares
  use boxes, only: boxes_t
  use clipping, only: positive_part
  use kinds, only: wp
  use level, only: level_t
  use mesh, only: mesh_t
  implicit none
  private
  public :: find_cell, upper_face, place_in, distance_at, measure_cell, measure_face

  real(wp), parameter :: on_wall = 1.0e-9_wp  !< of a cell: nearer is on the wall [-]
  real(wp), parameter :: nearest = 0.05_wp    !< least distance of a flow from its wall, over the thinnest edge of its cell [-]
  integer, parameter :: m = 4                 !< pieces along the edge of a face
  integer, parameter :: slices = 8            !< of a cell

contains

  !> Lowest corner and widths of a cell of my box or its halo.
  pure subroutine find_cell(boxes, mesh, cell, corner, h)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: cell(3)
    real(wp), intent(out) :: corner(3), h(3)  !< [m]

    integer :: a, place(3)

    place = boxes%lo + cell - 1
    place = merge(1 + modulo(place - 1, mesh%n), min(max(place, 1 - place), 2*mesh%n + 1 - place), mesh%periodic)
    place = min(max(place, 1), mesh%n)
    do a = 1, 3
      corner(a) = mesh%axis(a)%face(place(a) - 1)
      h(a) = mesh%axis(a)%width(place(a))
    end do
  end subroutine find_cell

  !> Where the upper face of a cell across a is [m].
  pure function upper_face(boxes, mesh, cell, a) result(x)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: cell(3), a
    real(wp) :: x

    integer :: face

    face = boxes%lo(a) + cell(a) - 1
    if (mesh%periodic(a)) face = modulo(face, mesh%n(a))
    x = mesh%axis(a)%face(min(max(face, 0), mesh%n(a)))
  end function upper_face

  !> A point of a face across a [m].
  pure function place_in(boxes, mesh, face, a, offset) result(x)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: face(3), a
    real(wp), intent(in) :: offset(3)  !< from its middle [m]
    real(wp) :: x(3)

    real(wp) :: corner(3), h(3)

    call find_cell(boxes, mesh, face, corner, h)
    x = corner + 0.5_wp*h + offset
    x(a) = upper_face(boxes, mesh, face, a)
  end function place_in

  !> Distance of a point of a face from the walls [m].
  pure function distance_at(boxes, mesh, walls, face, x) result(distance)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    class(level_t), intent(in) :: walls
    integer, intent(in) :: face(3)
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: distance

    real(wp) :: corner(3), h(3)

    call find_cell(boxes, mesh, face, corner, h)
    distance = max(walls%at(x), nearest*minval(h))
  end function distance_at

  !> Whether a cell or face has walls in it, and if not on which side it is.
  pure subroutine look_at(walls, corner, h, cut, open)
    class(level_t), intent(in) :: walls
    real(wp), intent(in) :: corner(3), h(3)  !< [m]
    logical, intent(out) :: cut, open

    real(wp) :: distance
    integer :: c

    distance = walls%at(corner + 0.5_wp*h)
    open = distance > 0.0_wp
    cut = abs(distance) <= 0.5_wp*norm2(h)*(1 + on_wall)
    do c = 0, 7
      if (cut) return
      distance = walls%at(corner + merge(h, 0.0_wp, [btest(c, 0), btest(c, 1), btest(c, 2)]))
      cut = (distance > 0.0_wp) .neqv. open
    end do
  end subroutine look_at

  !> The open part of a cell, in slices along z.
  pure subroutine measure_cell(walls, corner, h, part)
    class(level_t), intent(in) :: walls
    real(wp), intent(in) :: corner(3), h(3)  !< [m]
    real(wp), intent(out) :: part            !< [-]

    real(wp) :: slice, middle(3)
    logical :: cut, open
    integer :: s

    call look_at(walls, corner, h, cut, open)
    part = merge(1.0_wp, 0.0_wp, open)
    if (.not. cut) return
    part = 0.0_wp
    do s = 1, slices
      call measure_slice(walls, 3, corner + [0.0_wp, 0.0_wp, (s - 0.5_wp)/slices*h(3)], h, slice, middle)
      part = part + slice/slices
    end do
  end subroutine measure_cell

  pure subroutine measure_face(walls, a, corner, h, part, middle)
    class(level_t), intent(in) :: walls
    integer, intent(in) :: a
    real(wp), intent(in) :: corner(3), h(3)  !< [m]
    real(wp), intent(out) :: part            !< [-]
    real(wp), intent(out) :: middle(3)       !< of the open part, from that of the face [m]

    real(wp) :: flat(3)
    logical :: cut, open

    flat = h
    flat(a) = 0.0_wp
    middle = 0.0_wp
    call look_at(walls, corner, flat, cut, open)
    part = merge(1.0_wp, 0.0_wp, open)
    if (cut) call measure_slice(walls, a, corner, h, part, middle)
  end subroutine measure_face

  !> The open part of a rectangle across a.
  pure subroutine measure_slice(walls, a, corner, h, part, middle)
    class(level_t), intent(in) :: walls
    integer, intent(in) :: a
    real(wp), intent(in) :: corner(3), h(3)  !< [m]
    real(wp), intent(out) :: part            !< [-]
    real(wp), intent(out) :: middle(3)       !< of the open part, from that of the rectangle [m]

    real(wp) :: f(0:m, 0:m), area, moment(2), x(3)
    integer :: along(2), i, j

    along = pack([1, 2, 3], [1, 2, 3] /= a)
    x = corner
    do j = 0, m
      x(along(2)) = corner(along(2)) + h(along(2))*j/m
      do i = 0, m
        x(along(1)) = corner(along(1)) + h(along(1))*i/m
        f(i, j) = walls%at(x) - on_wall*minval(h)
      end do
    end do
    call positive_part(f, h(along), area, moment)
    part = area/product(h(along))
    middle = 0.0_wp
    if (part > 0.0_wp) middle(along) = moment/area
  end subroutine measure_slice

end module open_shares
