!> What happens on the surface of the domain, face of a cell by face of a cell, and at the walls within it that records name.
!>
!> A face belongs to the record whose box holds its centre; faces of no record are no-slip walls.
module gas_boundary
  use boundary_settings, only: boundary_settings_t
  use boxes, only: boxes_t
  use constants, only: is_set
  use gas_settings, only: gas_settings_t
  use inflow_ramp, only: inflow_ramp_t
  use inflow_speed, only: superficial, strength
  use inner_walls, only: inner_walls_t, find_inner_walls
  use kinds, only: wp
  use mesh, only: mesh_t
  use open_space, only: open_space_t
  use outcome, only: outcome_t, exit_input
  implicit none
  private
  public :: gas_boundary_t, new_gas_boundary, set_inflow

  !> The faces of my box on one side of the domain. All arrays have the shape of the side as seen from the velocity
  !> across it: (x,y,z) indices of the faces, one thick across, 0..n+1 along the side; the rims repeat or wrap.
  type :: side_t
    logical :: mine = .false.                     !< my box touches this side of the domain
    logical, allocatable :: open(:,:,:)           !< outflow: the pressure is given, the velocity is solved for
    real(wp), allocatable :: grip(:,:,:)          !< 1 where the velocity along the face is zero on it, 0 where it slips
    real(wp), allocatable :: flow(:,:,:)          !< superficial velocity into the domain [m/s]
    real(wp), allocatable :: pressure(:,:,:)      !< on open faces [Pa]
    real(wp), allocatable :: slide(:,:,:,:)       !< (face, component) velocity of the wall [m/s]; only where any wall moves
    integer, allocatable :: record(:,:,:)         !< which one it belongs to, 0 for none
    real(wp), allocatable, private :: area(:,:,:)     !< as far as it is open [m2]
    real(wp), allocatable, private :: share(:,:,:)    !< velocity over that of its record, or the table's; if any has a profile
    real(wp), allocatable, private :: nominal(:,:,:)  !< flow where factors are 1 [m/s]; only if any inflow changes
  end type side_t

  type :: gas_boundary_t
    type(side_t) :: side(2, 3)      !< (low or high, direction)
    type(inner_walls_t), allocatable :: walls  !< within the domain, if records name any
    logical :: any_open = .false.   !< some face of the domain is open, or some wall within it
    logical :: open_across(3) = .false.  !< some face across this direction is open
    real(wp) :: inflow = 0.0_wp     !< volume flow into the domain through all inflow faces [m3/s]
    type(inflow_ramp_t), allocatable, private :: ramp(:)  !< (records), only if any inflow changes
    real(wp), allocatable, private :: nominal(:)      !< their inflows where factors are 1 [m3/s]
  end type gas_boundary_t

contains

  !> Resolve the records on the surface of my box; mistakes that only the grid shows go into `outcome`.
  subroutine new_gas_boundary(boxes, mesh, records, settings, boundary, outcome, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: records(:)
    type(gas_settings_t), intent(in) :: settings
    type(gas_boundary_t), intent(out) :: boundary
    type(outcome_t), intent(inout) :: outcome
    type(open_space_t), intent(in), optional :: space  !< that walls leave

    real(wp) :: area(size(records)), shaped(size(records)), speed(size(records))
    integer :: a, end, overlap

    area = 0.0_wp
    shaped = 0.0_wp
    overlap = 0
    do a = 1, 3
      do end = 1, 2
        boundary%side(end, a)%mine = merge(boxes%at_low(a), boxes%at_high(a), end == 1)
        if (.not. boundary%side(end, a)%mine) cycle
        call measure_faces(boxes, mesh, a, end, boundary%side(end, a), space)
        call name_faces(boxes, mesh, records, a, boundary%side(end, a), overlap)
        call add_area(boundary%side(end, a), boxes, a, area)
        call shape_side(boxes, mesh, records, a, boundary%side(end, a), shaped)
      end do
    end do
    if (any(records%surface == 'walls') .and. present(space)) then
      allocate (boundary%walls)
      call find_inner_walls(boxes, mesh, records, space, boundary%walls, overlap)
      area = area + boundary%walls%areas(size(records))
    end if
    area = boxes%comm%sum(area)
    shaped = boxes%comm%sum(shaped)
    call check_records(records, area, shaped, boxes%comm%max(overlap), present(space), outcome)
    speed = superficial(records, area, shaped, settings%density)
    boundary%inflow = sum(speed*area)
    call settle_sides(boxes, records, strength(records, speed, area, shaped), settings%pressure, boundary)
    boundary%any_open = any(records%kind == 'outflow' .and. area > 0.0_wp)
    if (allocated(boundary%walls)) call boundary%walls%settle(records, speed, settings%pressure)
    call prepare_ramps(records, speed*area, boundary)
    if (boundary%inflow > 0.0_wp .and. .not. boundary%any_open .and. settings%density_law == 'constant') then
      call outcome%fail(exit_input, 'gas flows in but no &boundary is an outflow: an incompressible gas needs one')
    end if
  end subroutine new_gas_boundary

  !> Which record owns each face of one side, 0 for none. The last of several wins, after `overlap` has told of them.
  pure subroutine name_faces(boxes, mesh, records, a, side, overlap)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: records(:)
    integer, intent(in) :: a
    type(side_t), intent(inout) :: side
    integer, intent(inout) :: overlap  !< which two records hold one face: first + (second - 1)*size(records)

    integer :: i, j, k, m
    real(wp) :: x(3)

    do k = lbound(side%area, 3), ubound(side%area, 3)
      do j = lbound(side%area, 2), ubound(side%area, 2)
        do i = lbound(side%area, 1), ubound(side%area, 1)
          if (.not. side%area(i, j, k) > 0.0_wp) cycle
          x = face_centre(boxes, mesh, [i, j, k], a)
          do m = 1, size(records)
            if (records(m)%surface == 'walls' .or. .not. records(m)%holds(x, mesh%finest)) cycle
            if (side%record(i, j, k) /= 0) overlap = side%record(i, j, k) + (m - 1)*size(records)
            side%record(i, j, k) = m
          end do
        end do
      end do
    end do
  end subroutine name_faces

  !> Open areas of the faces of one side, which have no record yet.
  pure subroutine measure_faces(boxes, mesh, a, end, side, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: a, end
    type(side_t), intent(inout) :: side
    type(open_space_t), intent(in), optional :: space

    integer :: lo(3), hi(3)

    call side_bounds(boxes, a, end, lo, hi)
    allocate (side%record(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)), source=0)
    allocate (side%area(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)), source=mesh%areas(a, boxes%lo - 1 + lo, boxes%lo - 1 + hi))
    if (present(space)) side%area = side%area*space%area(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), a)
  end subroutine measure_faces

  !> Index bounds of the faces of a side, with a rim of one along it.
  pure subroutine side_bounds(boxes, a, end, lo, hi)
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: a, end
    integer, intent(out) :: lo(3), hi(3)

    lo = 0
    hi = boxes%n + 1
    lo(a) = merge(0, boxes%n(a), end == 1)
    hi(a) = lo(a)
  end subroutine side_bounds

  !> Centre [m] of the upper face across `a` of a cell of my box; indices beyond the grid are brought back into it.
  pure function face_centre(boxes, mesh, cell, a) result(x)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: cell(3), a
    real(wp) :: x(3)

    integer :: place(3)

    place = place_of(boxes, cell)
    place(a) = boxes%lo(a) + cell(a) - 1
    x = mesh%in_metres(place - 0.5_wp)
    x(a) = mesh%axis(a)%face(place(a))
  end function face_centre

  !> Where a cell of my box or its rim is in the whole grid, brought back into it.
  pure function place_of(boxes, cell) result(place)
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: cell(3)
    integer :: place(3)

    place = boxes%lo + cell - 1
    place = merge(1 + modulo(place - 1, boxes%cells), min(max(place, 1), boxes%cells), boxes%periodic)
  end function place_of

  !> Add the areas of my faces, rim left out, to those of their records.
  pure subroutine add_area(side, boxes, a, area)
    type(side_t), intent(in) :: side
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: a
    real(wp), intent(inout) :: area(:)

    integer :: m, lo(3), hi(3)

    lo = 1
    hi = boxes%n
    lo(a) = lbound(side%record, a)
    hi(a) = lo(a)
    associate (face => side%area(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)))
      do m = 1, size(area)
        area(m) = area(m) + sum(face, side%record(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)) == m)
      end do
    end associate
  end subroutine add_area

  !> Mistakes that only the grid shows. All ranks find the same.
  pure subroutine check_records(records, area, shaped, overlap, walled, outcome)
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: area(:), shaped(:)
    integer, intent(in) :: overlap
    logical, intent(in) :: walled  !< whether walls block the gas
    type(outcome_t), intent(inout) :: outcome

    integer :: m

    do m = 1, size(records)
      if (records(m)%profile == 'table' .and. area(m) > 0.0_wp .and. .not. shaped(m) > 0.0_wp) then
        call outcome%fail(exit_input, '&boundary '//trim(records(m)%id)//': its table lets nothing in through the region')
      end if
      if (area(m) > 0.0_wp) cycle
      if (records(m)%surface == 'walls') then
        call outcome%fail(exit_input, '&boundary '//trim(records(m)%id)//' holds the middle of no cell with a wall that blocks ' &
                          //'the gas: widen it')
        cycle
      end if
      call outcome%fail(exit_input, '&boundary '//trim(records(m)%id)//' holds the centre of no cell face on the ' &
                        //'surface of the domain'//trim(merge(' that walls leave open', repeat(' ', 22), walled)) &
                        //': move its corners onto a face that is not periodic, or widen it')
    end do
    if (overlap == 0) return
    call outcome%fail(exit_input, '&boundary '//trim(records(1 + modulo(overlap - 1, size(records)))%id) &
                      //' and &boundary '//trim(records(1 + (overlap - 1)/size(records))%id)//' overlap')
  end subroutine check_records

  !> From records to what the equations ask of each face.
  subroutine settle_sides(boxes, records, factor, reference, boundary)
    type(boxes_t), intent(in) :: boxes
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: factor(:)   !< see strength
    real(wp), intent(in) :: reference  !< pressure [Pa]
    type(gas_boundary_t), intent(inout) :: boundary

    integer :: a, end

    do a = 1, 3
      do end = 1, 2
        if (boundary%side(end, a)%mine) then
          call settle_side(records, factor, reference, boundary%side(end, a))
          boundary%open_across(a) = boundary%open_across(a) .or. any(boundary%side(end, a)%open)
        end if
      end do
      boundary%open_across(a) = boxes%comm%any_of(boundary%open_across(a))
    end do
  end subroutine settle_sides

  pure subroutine settle_side(records, factor, reference, side)
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: factor(:), reference
    type(side_t), intent(inout) :: side

    integer :: m

    associate (record => side%record)
      allocate (side%open(lbound(record, 1):ubound(record, 1), lbound(record, 2):ubound(record, 2), &
                          lbound(record, 3):ubound(record, 3)), source=.false.)
      allocate (side%grip(lbound(record, 1):ubound(record, 1), lbound(record, 2):ubound(record, 2), &
                          lbound(record, 3):ubound(record, 3)), source=1.0_wp)
      allocate (side%flow, side%pressure, source=side%grip)
      side%flow = 0.0_wp
      side%pressure = reference
      do m = 1, size(records)
        where (record == m)
          side%open = records(m)%kind == 'outflow'
          side%grip = merge(0.0_wp, 1.0_wp, records(m)%kind == 'slip' .or. records(m)%kind == 'outflow')
          side%flow = factor(m)
        end where
        if (.not. is_set(records(m)%pressure)) cycle
        where (record == m) side%pressure = records(m)%pressure
      end do
    end associate
    if (allocated(side%share)) side%flow = side%share*side%flow
    call set_slide(records, side)
  end subroutine settle_side

  !> The velocity of the walls that move.
  pure subroutine set_slide(records, side)
    type(boundary_settings_t), intent(in) :: records(:)
    type(side_t), intent(inout) :: side

    integer :: m, b

    do m = 1, size(records)
      if (.not. any(abs(records(m)%wall_velocity) > 0.0_wp)) cycle
      if (.not. any(side%record == m)) cycle
      associate (lo => lbound(side%record), hi => ubound(side%record))
        if (.not. allocated(side%slide)) allocate (side%slide(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), 3), source=0.0_wp)
      end associate
      do b = 1, 3
        where (side%record == m) side%slide(:, :, :, b) = records(m)%wall_velocity(b)
      end do
    end do
  end subroutine set_slide

  !> The shares of the faces of one side, if any record has a profile, and what they add up to, rim left out.
  pure subroutine shape_side(boxes, mesh, records, a, side, shaped)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: records(:)
    integer, intent(in) :: a
    type(side_t), intent(inout) :: side
    real(wp), intent(inout) :: shaped(:)  !< sums of area times share [m2], or [m3/s] of a table

    integer :: i, j, k, m, rim(3)

    if (all(records%profile == 'uniform')) return
    allocate (side%share, mold=side%area)
    side%share = 1.0_wp
    do k = lbound(side%record, 3), ubound(side%record, 3)
      do j = lbound(side%record, 2), ubound(side%record, 2)
        do i = lbound(side%record, 1), ubound(side%record, 1)
          m = side%record(i, j, k)
          if (m == 0) cycle
          if (records(m)%profile == 'uniform') cycle
          side%share(i, j, k) = share_of(boxes, mesh, records(m), [i, j, k], a)
          rim = [i, j, k]
          rim(a) = 1
          if (all(rim >= 1 .and. rim <= boxes%n)) shaped(m) = shaped(m) + side%share(i, j, k)*side%area(i, j, k)
        end do
      end do
    end do
  end subroutine shape_side

  !> Of the face above a cell: that of a parabola, of no scale, or the mean over it of a table [m/s].
  pure function share_of(boxes, mesh, record, cell, a) result(share)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: record
    integer, intent(in) :: cell(3), a
    real(wp) :: share

    real(wp) :: corner(3, 2)
    integer :: place(3), b

    if (record%profile == 'parabola') then
      share = bow(mesh, record, face_centre(boxes, mesh, cell, a), a)
      return
    end if
    place = place_of(boxes, cell)
    do b = 1, 3
      corner(b, :) = mesh%axis(b)%face([place(b) - 1, place(b)])
    end do
    share = record%table%mean_over(corner(:, 1), corner(:, 2))
  end function share_of

  !> s (1 - s) along each direction, s from edge to edge of the region.
  pure function bow(mesh, record, x, a)
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: record
    real(wp), intent(in) :: x(3)  !< [m]
    integer, intent(in) :: a
    real(wp) :: bow

    real(wp) :: low(3), high(3)
    integer :: b

    low = max(record%lower, mesh%lower)
    high = min(record%upper, mesh%upper)
    bow = 1.0_wp
    do b = 1, 3
      if (b == a .or. mesh%n(b) == 1 .or. mesh%periodic(b)) cycle
      bow = bow*max(0.0_wp, (x(b) - low(b))*(high(b) - x(b)))/(high(b) - low(b))**2
    end do
  end function bow

  !> What is needed of inflows that change.
  pure subroutine prepare_ramps(records, inflow, boundary)
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: inflow(:)  !< [m3/s]
    type(gas_boundary_t), intent(inout) :: boundary

    integer :: a, end, m

    if (.not. any([(allocated(records(m)%times), m=1, size(records))])) return
    allocate (boundary%ramp(size(records)))
    boundary%nominal = inflow
    do m = 1, size(records)
      if (.not. allocated(records(m)%times)) cycle
      boundary%ramp(m)%times = records(m)%times
      boundary%ramp(m)%factors = records(m)%factors
    end do
    do a = 1, 3
      do end = 1, 2
        if (boundary%side(end, a)%mine) boundary%side(end, a)%nominal = boundary%side(end, a)%flow
      end do
    end do
  end subroutine prepare_ramps

  !> Inflows as they are at a time.
  pure subroutine set_inflow(boundary, time)
    type(gas_boundary_t), intent(inout) :: boundary
    real(wp), intent(in) :: time  !< [s]

    integer :: a, end, m
    real(wp) :: factor

    if (.not. allocated(boundary%ramp)) return
    boundary%inflow = 0.0_wp
    do m = 1, size(boundary%ramp)
      factor = 1.0_wp
      if (allocated(boundary%ramp(m)%times)) factor = boundary%ramp(m)%at(time)
      boundary%inflow = boundary%inflow + factor*boundary%nominal(m)
      if (allocated(boundary%walls)) call boundary%walls%multiply(m, factor)
      do a = 1, 3
        do end = 1, 2
          if (.not. boundary%side(end, a)%mine) cycle
          associate (side => boundary%side(end, a))
            where (side%record == m) side%flow = factor*side%nominal
          end associate
        end do
      end do
    end do
  end subroutine set_inflow

end module gas_boundary
