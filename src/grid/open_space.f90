!> The part of the grid that walls leave to the gas: how much of each cell and of each face is open, how much wall a cell has
!> and how far it is.
!>
!> Where the distance from the walls is positive is found on a lattice in each face, linear between its points; a cell is the
!> sum of slices. A cell that is hardly open, or that has no open face, is closed. The wall in a cell is what closes its
!> surface: its vector area is the difference of those of opposite faces,
!>
!>   A_wall = |sum over faces of alpha A n|.                                                          (1)
!>
!> All arrays are those of the box, two layers of halo included, indices as in gas_state; each rank makes its own, halos
!> from the same places as their owners. Beyond the surface of the domain they mirror what is within.
module open_space
  use boxes, only: boxes_t
  use clipping, only: positive_part
  use kinds, only: wp
  use level, only: level_t
  use mesh, only: mesh_t
  implicit none
  private
  public :: open_space_t, new_open_space, least_open

  real(wp), parameter :: least_open = 0.05_wp  !< of a cell: with less it is closed [-]
  real(wp), parameter :: nearest = 0.05_wp     !< least distance of a flow from its wall, over the thinnest cell [-]
  real(wp), parameter :: closest = 0.25_wp     !< least distance of two flows, over that of their cells [-]
  real(wp), parameter :: on_wall = 1.0e-9_wp   !< of a cell: nearer is on the wall [-]
  integer, parameter :: m = 4                  !< pieces along the edge of a face
  integer, parameter :: slices = 8             !< of a cell

  type :: open_space_t
    real(wp), allocatable :: volume(:,:,:)      !< open part of cells, 0 of closed ones [-]
    real(wp), allocatable :: area(:,:,:,:)      !< (face, a) open part of faces [-]
    real(wp), allocatable :: wall(:,:,:)        !< in cells [m2]
    real(wp), allocatable :: nearness(:,:,:,:)  !< (face, a) 1 over the distance of the flow through a face from the wall [1/m]
    real(wp), allocatable :: upper(:,:,:,:)     !< (cell, a) share of the upper face across a in what acts on a cell's gas [-]
    real(wp), allocatable :: bridge(:,:,:,:,:)  !< (face, b, a) viscous area over distance between the flows through a face
                                                !< across a and the next one along b, over the same without walls [-]
    logical, allocatable :: closed(:,:,:)       !< (n1,n2,n3) cells without gas
    integer :: first_open(3) = 0                !< the first cell of the whole grid that is open; 0 if none is
    real(wp) :: open_volume = 0.0_wp            !< of the whole grid [m3]
    real(wp) :: lost_volume = 0.0_wp            !< that is open but in closed cells [m3]
    integer :: lost_cells = 0                   !< which are so many
    integer :: pockets = 0                      !< parts without a way out that are closed
    real(wp) :: pocket_volume = 0.0_wp          !< of all of them [m3]
    real(wp) :: pocket_place(3) = 0.0_wp        !< of a cell of the first [m]
  contains
    procedure :: shut_off
  end type open_space_t

contains

  !> All ranks together.
  subroutine new_open_space(boxes, mesh, walls, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    class(level_t), intent(in) :: walls
    type(open_space_t), intent(out) :: space

    real(wp), allocatable :: offset(:,:,:,:,:)

    associate (n => boxes%n)
      allocate (space%volume(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2), source=1.0_wp)
      allocate (space%area(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2, 3), source=1.0_wp)
      allocate (offset(3, -1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2, 3), source=0.0_wp)
      allocate (space%closed(n(1), n(2), n(3)), source=.false.)
    end associate
    allocate (space%upper(lbound(space%area, 1):ubound(space%area, 1), lbound(space%area, 2):ubound(space%area, 2), &
                          lbound(space%area, 3):ubound(space%area, 3), 3), source=0.5_wp)
    call measure(boxes, mesh, walls, space, offset)
    call close_cells(boxes, mesh, space)
    call find_walls(boxes, mesh, walls, offset, space)
    call find_bridges(boxes, mesh, offset, space)
  end subroutine new_open_space

  !> Open parts as the walls leave them, and where the middles of those of faces are.
  pure subroutine measure(boxes, mesh, walls, space, offset)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    class(level_t), intent(in) :: walls
    type(open_space_t), intent(inout) :: space
    real(wp), intent(inout) :: offset(:, -1:, -1:, -1:, :)  !< (3, face, a) from the middle of the face [m]

    real(wp) :: corner(3), h(3)
    integer :: a, i, j, k

    do k = -1, boxes%n(3) + 2
      do j = -1, boxes%n(2) + 2
        do i = -1, boxes%n(1) + 2
          call find_cell(boxes, mesh, [i, j, k], corner, h)
          call measure_cell(walls, corner, h, space%volume(i, j, k))
          do a = 1, 3
            call find_cell(boxes, mesh, [i, j, k], corner, h)
            corner(a) = upper_face(boxes, mesh, [i, j, k], a)
            call measure_face(walls, a, corner, h, space%area(i, j, k, a), offset(:, i, j, k, a))
          end do
        end do
      end do
    end do
  end subroutine measure

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

  !> Close the cells that are hardly open, the faces of closed cells, and the cells these leave without a face.
  subroutine close_cells(boxes, mesh, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(open_space_t), intent(inout) :: space

    real(wp), dimension(boxes%n(1), boxes%n(2), boxes%n(3)) :: raw, cell_volume
    real(wp) :: sums(3)
    integer :: a, n(3), last(3), e(3), i, j, k

    n = boxes%n
    raw = space%volume(1:n(1), 1:n(2), 1:n(3))
    cell_volume = mesh%volumes(boxes%lo, boxes%hi)
    where (space%volume < least_open) space%volume = 0.0_wp
    do a = 1, 3
      e = 0
      e(a) = 1
      last = n + 2 - e
      do k = -1, last(3)
        do j = -1, last(2)
          do i = -1, last(1)
            if (min(space%volume(i, j, k), space%volume(i + e(1), j + e(2), k + e(3))) > 0.0_wp) cycle
            space%area(i, j, k, a) = 0.0_wp
          end do
        end do
      end do
    end do
    do k = 1, n(3)
      do j = 1, n(2)
        do i = 1, n(1)
          space%closed(i, j, k) = .not. any([space%area(i, j, k, :), space%area(i - 1, j, k, 1), space%area(i, j - 1, k, 2), &
                                             space%area(i, j, k - 1, 3)] > 0.0_wp)
        end do
      end do
    end do
    where (space%closed) space%volume(1:n(1), 1:n(2), 1:n(3)) = 0.0_wp
    sums = boxes%comm%sum([sum(raw*cell_volume, .not. space%closed), sum(raw*cell_volume, space%closed), &
                           real(count(space%closed .and. raw > 0.0_wp), wp)])
    space%open_volume = sums(1)
    space%lost_volume = sums(2)
    space%lost_cells = nint(sums(3))
    call find_first(boxes, space)
  end subroutine close_cells

  !> Close cells that no open face connects with the others.
  subroutine shut_off(self, boxes, mesh, shut)
    class(open_space_t), intent(inout) :: self
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    logical, intent(in) :: shut(-1:, -1:, -1:)  !< those of my box and its halo

    integer :: a, i, j, k, e(3), n(3)

    n = boxes%n
    associate (inner => shut(1:n(1), 1:n(2), 1:n(3)))
      self%pocket_volume = boxes%comm%sum(sum(self%volume(1:n(1), 1:n(2), 1:n(3))*mesh%volumes(boxes%lo, boxes%hi), inner))
      self%closed = self%closed .or. inner
    end associate
    self%open_volume = self%open_volume - self%pocket_volume
    where (shut) self%volume = 0.0_wp
    do a = 1, 3
      e = 0
      e(a) = 1
      do k = -1, n(3) + 1
        do j = -1, n(2) + 1
          do i = -1, n(1) + 1
            if (shut(i, j, k) .or. shut(i + e(1), j + e(2), k + e(3))) self%area(i, j, k, a) = 0.0_wp
          end do
        end do
      end do
    end do
    call find_first(boxes, self)
  end subroutine shut_off

  !> The open cell of the lowest number in the whole grid.
  subroutine find_first(boxes, space)
    type(boxes_t), intent(in) :: boxes
    class(open_space_t), intent(inout) :: space

    real(wp) :: number, lowest
    integer :: cell(3), i, j, k

    lowest = huge(1.0_wp)
    do k = 1, boxes%n(3)
      do j = 1, boxes%n(2)
        do i = 1, boxes%n(1)
          if (space%closed(i, j, k)) cycle
          cell = boxes%lo + [i, j, k] - 2
          number = cell(1) + boxes%cells(1)*(cell(2) + real(boxes%cells(2), wp)*cell(3))
          lowest = min(lowest, number)
        end do
      end do
    end do
    lowest = boxes%comm%min(lowest)
    if (.not. lowest < huge(1.0_wp)) return
    cell(1) = int(modulo(lowest, real(boxes%cells(1), wp)))
    lowest = (lowest - cell(1))/boxes%cells(1)
    cell(2) = int(modulo(lowest, real(boxes%cells(2), wp)))
    cell(3) = nint((lowest - cell(2))/boxes%cells(2))
    space%first_open = cell + 1
  end subroutine find_first

  !> The walls in cells, by (1), how near they are, and how a cell's two faces share.
  pure subroutine find_walls(boxes, mesh, walls, offset, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    class(level_t), intent(in) :: walls
    real(wp), intent(in) :: offset(:, -1:, -1:, -1:, :)
    type(open_space_t), intent(inout) :: space

    real(wp) :: corner(3), h(3), pair(2), facing(3)
    integer :: a, i, j, k, e(3), n(3)

    n = boxes%n
    allocate (space%wall(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2), source=0.0_wp)
    allocate (space%nearness(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2, 3), source=0.0_wp)
    do k = 0, n(3) + 1
      do j = 0, n(2) + 1
        do i = 0, n(1) + 1
          call find_cell(boxes, mesh, [i, j, k], corner, h)
          do a = 1, 3
            e = 0
            e(a) = 1
            pair = [space%area(i - e(1), j - e(2), k - e(3), a), space%area(i, j, k, a)]
            facing(a) = (pair(2) - pair(1))*product(h)/h(a)
            if (sum(pair) > 0.0_wp) space%upper(i, j, k, a) = pair(2)/sum(pair)
          end do
          space%wall(i, j, k) = norm2(facing)
        end do
      end do
    end do
    do a = 1, 3
      e = 0
      e(a) = 1
      do k = 0, n(3)
        do j = 0, n(2)
          do i = 0, n(1)
            if (.not. space%wall(i, j, k) + space%wall(i + e(1), j + e(2), k + e(3)) > 0.0_wp) cycle
            call find_cell(boxes, mesh, [i, j, k], corner, h)
            corner = corner + 0.5_wp*h + offset(:, i, j, k, a)
            corner(a) = upper_face(boxes, mesh, [i, j, k], a)
            space%nearness(i, j, k, a) = 1/max(walls%at(corner), nearest*minval(h))
          end do
        end do
      end do
    end do
  end subroutine find_walls

  !> Between the flows through two faces across a, beside each other along b or one behind the other.
  pure subroutine find_bridges(boxes, mesh, offset, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    real(wp), intent(in) :: offset(:, -1:, -1:, -1:, :)
    type(open_space_t), intent(inout) :: space

    real(wp) :: gap, part
    integer :: a, b, i, j, k, e(3), s(3), n(3)

    n = boxes%n
    allocate (space%bridge(-1:n(1), -1:n(2), -1:n(3), 3, 3), source=0.0_wp)
    do a = 1, 3
      e = 0
      e(a) = 1
      do b = 1, 3
        s = 0
        s(b) = 1
        do k = -1, n(3)
          do j = -1, n(2)
            do i = -1, n(1)
              if (min(space%area(i, j, k, a), space%area(i + s(1), j + s(2), k + s(3), a)) <= 0.0_wp) cycle
              if (a == b) then
                space%bridge(i, j, k, b, a) = space%volume(i + e(1), j + e(2), k + e(3))
                cycle
              end if
              part = 0.5_wp*(space%area(i, j, k, b) + space%area(i + e(1), j + e(2), k + e(3), b))
              gap = mesh%axis(b)%gap(boxes%lo(b) - 1 + dot_product(s, [i, j, k]))
              space%bridge(i, j, k, b, a) = part*gap/max(closest*gap, gap + offset(b, i + s(1), j + s(2), k + s(3), a) &
                                                         - offset(b, i, j, k, a))
            end do
          end do
        end do
      end do
    end do
  end subroutine find_bridges

end module open_space
