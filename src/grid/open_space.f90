!> The part of the grid that walls leave to the gas: how much of each cell and of each face is open, how much wall a cell has
!> and how far it is.
!>
!> A cell that is hardly open, or that has no open face, is closed. The wall in a cell is what closes its
!> surface: its vector area is the difference of those of opposite faces,
!>
!>   A_wall = |sum over faces of alpha A n|.                                                          (1)
!>
!> All arrays are those of the box, two layers of halo included, indices as in gas_state; each rank makes its own, halos
!> from the same places as their owners. Beyond the surface of the domain they mirror what is within.
module open_space
  use boxes, only: boxes_t
  use kinds, only: wp
  use level, only: level_t
  use mesh, only: mesh_t, unit_step
  use open_shares, only: find_cell, upper_face, measure_cell, measure_face, place_in, distance_at
  implicit none
  private
  public :: open_space_t, tilt_t, new_open_space, let_slip, least_open

  real(wp), parameter :: least_open = 0.05_wp  !< of a cell: with less it is closed [-]
  real(wp), parameter :: least_wall = 1.0e-9_wp  !< in a cell, over its largest face: less is round-off [-]
  real(wp), parameter :: closest = 0.25_wp     !< least distance of two flows, over that of their cells [-]

  real(wp), parameter :: steepest = 3.0_wp     !< most by which a flow is more beside its middle than in it [-]

  !> The flows through two faces across a, one behind the other along b, whose middles are not level with that of the surface
  !> between them. The velocity relative to the wall grows in proportion to the distance from it, so what it is beside the
  !> middle is known: its viscous stress there is that of (1 + more) u.
  type :: tilt_t
    integer :: a, b
    integer :: face(3)    !< the lower of the two
    real(wp) :: more(2)   !< lower and upper flow [-]
  end type tilt_t

  type :: open_space_t
    real(wp), allocatable :: volume(:,:,:)      !< open part of cells, 0 of closed ones [-]
    real(wp), allocatable :: area(:,:,:,:)      !< (face, a) open part of faces [-]
    real(wp), allocatable :: wall(:,:,:)        !< in cells [m2]
    logical, allocatable :: beside(:,:,:)       !< (n1,n2,n3) cells with walls, and those that share a face with such where the gas
                                                !< sticks to it
    real(wp), allocatable :: nearness(:,:,:,:)  !< (face, a) 1 over the distance of the flow through a face from the wall [1/m]
    real(wp), allocatable :: slide(:,:,:,:)     !< (face, a) component a of the velocity of that wall [m/s]; only if any moves
    real(wp), allocatable :: upper(:,:,:,:)     !< (cell, a) share of the upper face across a in what acts on a cell's gas [-]
    real(wp), allocatable :: bridge(:,:,:,:,:)  !< (face, b, a) viscous area over distance between the flows through a face
                                                !< across a and the next one along b, over the same without walls [-]
    type(tilt_t), allocatable :: tilts(:)       !< of faces with a part in the rows of my box
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
    call find_tilts(boxes, mesh, walls, offset, space)
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
      e = unit_step(a)
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
      e = unit_step(a)
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

  !> The walls in cells, by (1), how near they are and how they move, and how a cell's two faces share.
  pure subroutine find_walls(boxes, mesh, walls, offset, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    class(level_t), intent(in) :: walls
    real(wp), intent(in) :: offset(:, -1:, -1:, -1:, :)
    type(open_space_t), intent(inout) :: space

    real(wp) :: corner(3), h(3), pair(2), facing(3), x(3), velocity(3)
    integer :: a, i, j, k, e(3), n(3)

    n = boxes%n
    allocate (space%wall(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2), source=0.0_wp)
    allocate (space%nearness(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2, 3), source=0.0_wp)
    if (walls%moves()) allocate (space%slide, source=space%nearness)
    do k = 0, n(3) + 1
      do j = 0, n(2) + 1
        do i = 0, n(1) + 1
          call find_cell(boxes, mesh, [i, j, k], corner, h)
          do a = 1, 3
            e = unit_step(a)
            pair = [space%area(i - e(1), j - e(2), k - e(3), a), space%area(i, j, k, a)]
            facing(a) = (pair(2) - pair(1))*product(h)/h(a)
            if (sum(pair) > 0.0_wp) space%upper(i, j, k, a) = pair(2)/sum(pair)
          end do
          if (norm2(facing) > least_wall*maxval(product(h)/h)) space%wall(i, j, k) = norm2(facing)
        end do
      end do
    end do
    allocate (space%beside(n(1), n(2), n(3)))
    call find_beside(space%wall(0:n(1) + 1, 0:n(2) + 1, 0:n(3) + 1) > 0.0_wp, space)
    do a = 1, 3
      e = unit_step(a)
      do k = 0, n(3) + 1 - e(3)
        do j = 0, n(2) + 1 - e(2)
          do i = 0, n(1) + 1 - e(1)
            if (.not. (is_beside(space, n, [i, j, k]) .or. is_beside(space, n, [i, j, k] + e))) cycle
            x = place_in(boxes, mesh, [i, j, k], a, offset(:, i, j, k, a))
            space%nearness(i, j, k, a) = 1/distance_at(boxes, mesh, walls, [i, j, k], x)
            if (.not. allocated(space%slide)) cycle
            velocity = walls%velocity(x)
            space%slide(i, j, k, a) = velocity(a)
          end do
        end do
      end do
    end do
  end subroutine find_walls

  !> See open_space_t; `holds` are the cells, those around my box included, with walls to which the gas sticks.
  pure subroutine find_beside(holds, space)
    logical, intent(in) :: holds(0:, 0:, 0:)  !< (0:n1+1,0:n2+1,0:n3+1)
    type(open_space_t), intent(inout) :: space

    integer :: n(3)

    n = shape(space%beside)
    space%beside = space%wall(1:n(1), 1:n(2), 1:n(3)) > 0.0_wp &
      .or. holds(0:n(1) - 1, 1:n(2), 1:n(3)) .or. holds(2:n(1) + 1, 1:n(2), 1:n(3)) &
      .or. holds(1:n(1), 0:n(2) - 1, 1:n(3)) .or. holds(1:n(1), 2:n(2) + 1, 1:n(3)) &
      .or. holds(1:n(1), 1:n(2), 0:n(3) - 1) .or. holds(1:n(1), 1:n(2), 2:n(3) + 1)
  end subroutine find_beside

  !> Whether a cell of my box is beside a wall, or one around it has one itself.
  pure function is_beside(space, n, cell)
    type(open_space_t), intent(in) :: space
    integer, intent(in) :: n(3), cell(3)
    logical :: is_beside

    is_beside = space%wall(cell(1), cell(2), cell(3)) > 0.0_wp
    if (all(cell >= 1 .and. cell <= n)) is_beside = is_beside .or. space%beside(cell(1), cell(2), cell(3))
  end function is_beside

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
      e = unit_step(a)
      do b = 1, 3
        s = unit_step(b)
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

  !> Let the gas slip along the walls of some cells: a flow beside them is as near to walls as those on which it sticks make it.
  pure subroutine let_slip(boxes, slips, space)
    type(boxes_t), intent(in) :: boxes
    logical, intent(in) :: slips(0:, 0:, 0:)  !< (0:n1+1,0:n2+1,0:n3+1)
    type(open_space_t), intent(inout) :: space

    real(wp) :: grip(0:boxes%n(1) + 1, 0:boxes%n(2) + 1, 0:boxes%n(3) + 1, 3), wall(2)
    integer :: a, i, j, k, e(3), n(3), m, x(3)

    n = boxes%n
    grip = 1.0_wp
    do a = 1, 3
      e = unit_step(a)
      do k = 0, n(3) + 1 - e(3)
        do j = 0, n(2) + 1 - e(2)
          do i = 0, n(1) + 1 - e(1)
            x = [i, j, k] + e
            if (.not. (slips(i, j, k) .or. slips(x(1), x(2), x(3)))) cycle
            wall = [space%upper(i, j, k, a), 1 - space%upper(x(1), x(2), x(3), a)] &
              *[space%wall(i, j, k), space%wall(x(1), x(2), x(3))]
            grip(i, j, k, a) = 0.0_wp
            if (sum(wall) > 0.0_wp) grip(i, j, k, a) = sum(wall, .not. [slips(i, j, k), slips(x(1), x(2), x(3))])/sum(wall)
          end do
        end do
      end do
    end do
    associate (near => space%nearness(0:n(1) + 1, 0:n(2) + 1, 0:n(3) + 1, :))
      near = grip*near
    end associate
    call find_beside(space%wall(0:n(1) + 1, 0:n(2) + 1, 0:n(3) + 1) > 0.0_wp .and. .not. slips, space)
    do m = 1, size(space%tilts)
      associate (tilt => space%tilts(m))
        x = tilt%face
        tilt%more(1) = grip(x(1), x(2), x(3), tilt%a)*tilt%more(1)
        x(tilt%b) = x(tilt%b) + 1
        tilt%more(2) = grip(x(1), x(2), x(3), tilt%a)*tilt%more(2)
      end associate
    end do
  end subroutine let_slip

  !> See tilt_t.
  pure subroutine find_tilts(boxes, mesh, walls, offset, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    class(level_t), intent(in) :: walls
    real(wp), intent(in) :: offset(:, -1:, -1:, -1:, :)
    type(open_space_t), intent(inout) :: space

    type(tilt_t) :: tilt
    type(tilt_t), allocatable :: longer(:)
    integer :: a, b, i, j, k, n

    n = 0
    allocate (space%tilts(64))
    do a = 1, 3
      do b = 1, 3
        if (b == a) cycle
        do k = 0, boxes%n(3)
          do j = 0, boxes%n(2)
            do i = 0, boxes%n(1)
              tilt = tilt_t(a, b, [i, j, k], [0.0_wp, 0.0_wp])
              call find_tilt(boxes, mesh, walls, offset, space, tilt)
              if (.not. any(abs(tilt%more) > 0.0_wp)) cycle
              if (n == size(space%tilts)) then
                allocate (longer(2*n))
                longer(:n) = space%tilts
                call move_alloc(longer, space%tilts)
              end if
              n = n + 1
              space%tilts(n) = tilt
            end do
          end do
        end do
      end do
    end do
    space%tilts = space%tilts(:n)
  end subroutine find_tilts

  !> Of one pair of faces; nothing across the surface of the domain.
  pure subroutine find_tilt(boxes, mesh, walls, offset, space, tilt)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    class(level_t), intent(in) :: walls
    real(wp), intent(in) :: offset(:, -1:, -1:, -1:, :)
    type(open_space_t), intent(in) :: space
    type(tilt_t), intent(inout) :: tilt

    real(wp) :: area(2), place(3), middle(3, 2), distance(2)
    integer :: face(3, 2), along, across(3), side

    associate (a => tilt%a, b => tilt%b)
      if (.not. mesh%periodic(b) .and. (boxes%lo(b) + tilt%face(b) < 2 .or. boxes%lo(b) + tilt%face(b) > mesh%n(b))) return
      along = 6 - a - b
      face = spread(tilt%face, 2, 2)
      face(b, 2) = face(b, 2) + 1
      across = tilt%face
      across(a) = across(a) + 1
      do side = 1, 2
        if (.not. space%area(face(1, side), face(2, side), face(3, side), a) > 0.0_wp) return
        middle(:, side) = offset(:, face(1, side), face(2, side), face(3, side), a)
      end do
      area = [space%area(tilt%face(1), tilt%face(2), tilt%face(3), b), space%area(across(1), across(2), across(3), b)]
      if (.not. sum(area) > 0.0_wp) return
      place = (area(1)*offset(:, tilt%face(1), tilt%face(2), tilt%face(3), b) &
               + area(2)*offset(:, across(1), across(2), across(3), b))/sum(area)
      do side = 1, 2
        if (.not. abs(place(along) - middle(along, side)) > 0.0_wp) cycle
        distance(1) = distance_at(boxes, mesh, walls, face(:, side), place_in(boxes, mesh, face(:, side), a, middle(:, side)))
        middle(along, side) = place(along)
        distance(2) = distance_at(boxes, mesh, walls, face(:, side), place_in(boxes, mesh, face(:, side), a, middle(:, side)))
        tilt%more(side) = min(distance(2)/distance(1), steepest) - 1
      end do
    end associate
  end subroutine find_tilt

end module open_space
