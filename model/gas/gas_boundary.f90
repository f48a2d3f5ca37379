!> What happens on the surface of the domain, face of a cell by face of a cell.
!>
!> A face belongs to the record whose box holds its centre; faces of no record are no-slip walls.
module gas_boundary
  use boundary_settings, only: boundary_settings_t
  use boxes, only: boxes_t
  use constants, only: is_set
  use gas_settings, only: gas_settings_t
  use kinds, only: wp
  use mesh, only: mesh_t
  use open_space, only: open_space_t
  use outcome, only: outcome_t, exit_input
  implicit none
  private
  public :: gas_boundary_t, new_gas_boundary, set_inflow

  real(wp), parameter :: closeness = 1.0e-6_wp  !< of a cell's edge: what counts as lying on a plane

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
    real(wp), allocatable, private :: nominal(:,:,:)  !< flow where factors are 1 [m/s]; only if any inflow changes
  end type side_t

  !> How the inflow of a record changes: by factors at times, linear between, constant before and after.
  type :: ramp_t
    real(wp), allocatable :: times(:)    !< [s]
    real(wp), allocatable :: factors(:)
  end type ramp_t

  type :: gas_boundary_t
    type(side_t) :: side(2, 3)      !< (low or high, direction)
    logical :: any_open = .false.   !< some face of the domain is open
    logical :: open_across(3) = .false.  !< some face across this direction is open
    real(wp) :: inflow = 0.0_wp     !< volume flow into the domain through all inflow faces [m3/s]
    type(ramp_t), allocatable, private :: ramp(:)     !< (records), only if any inflow changes
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

    real(wp) :: area(size(records)), speed(size(records))
    integer :: a, end, overlap

    area = 0.0_wp
    overlap = 0
    do a = 1, 3
      do end = 1, 2
        boundary%side(end, a)%mine = merge(boxes%at_low(a), boxes%at_high(a), end == 1)
        if (.not. boundary%side(end, a)%mine) cycle
        call measure_faces(boxes, mesh, a, end, boundary%side(end, a), space)
        call name_faces(boxes, mesh, records, a, boundary%side(end, a), overlap)
        call add_area(boundary%side(end, a), boxes, a, area)
      end do
    end do
    area = boxes%comm%sum(area)
    call check_records(records, area, boxes%comm%max(overlap), present(space), outcome)
    speed = superficial(records, area, settings%density)
    boundary%inflow = sum(speed*area)
    call settle_sides(boxes, records, speed, settings%pressure, boundary)
    call shape_inflow(boxes, mesh, records, area, boundary)
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
            if (.not. holds(records(m), x, mesh%finest)) cycle
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

    place = boxes%lo + cell - 1
    place = merge(1 + modulo(place - 1, boxes%cells), min(max(place, 1), boxes%cells), boxes%periodic)
    place(a) = boxes%lo(a) + cell(a) - 1
    x = mesh%in_metres(place - 0.5_wp)
    x(a) = mesh%axis(a)%face(place(a))
  end function face_centre

  pure function holds(record, x, h)
    type(boundary_settings_t), intent(in) :: record
    real(wp), intent(in) :: x(3), h(3)
    logical :: holds

    holds = all(x >= record%lower - closeness*h .and. x <= record%upper + closeness*h)
  end function holds

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
  pure subroutine check_records(records, area, overlap, walled, outcome)
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: area(:)
    integer, intent(in) :: overlap
    logical, intent(in) :: walled  !< whether walls block the gas
    type(outcome_t), intent(inout) :: outcome

    integer :: m

    do m = 1, size(records)
      if (area(m) > 0.0_wp) cycle
      call outcome%fail(exit_input, '&boundary '//trim(records(m)%id)//' holds the centre of no cell face on the ' &
                        //'surface of the domain'//trim(merge(' that walls leave open', repeat(' ', 22), walled)) &
                        //': move its corners onto a face that is not periodic, or widen it')
    end do
    if (overlap == 0) return
    call outcome%fail(exit_input, '&boundary '//trim(records(1 + modulo(overlap - 1, size(records)))%id) &
                      //' and &boundary '//trim(records(1 + (overlap - 1)/size(records))%id)//' overlap')
  end subroutine check_records

  !> Superficial velocity into the domain of each record [m/s]; 0 for all but inflows.
  pure function superficial(records, area, density) result(speed)
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: area(:)   !< [m2]
    real(wp), intent(in) :: density   !< [kg/m3]
    real(wp) :: speed(size(records))

    integer :: m

    speed = 0.0_wp
    do m = 1, size(records)
      if (records(m)%kind /= 'inflow' .or. .not. area(m) > 0.0_wp) cycle
      if (is_set(records(m)%velocity)) then
        speed(m) = records(m)%velocity
      else if (is_set(records(m)%volume_flow)) then
        speed(m) = records(m)%volume_flow/area(m)
      else
        speed(m) = records(m)%mass_flow/(density*area(m))
      end if
    end do
  end function superficial

  !> From records to what the equations ask of each face.
  subroutine settle_sides(boxes, records, speed, reference, boundary)
    type(boxes_t), intent(in) :: boxes
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: speed(:), reference
    type(gas_boundary_t), intent(inout) :: boundary

    integer :: a, end

    do a = 1, 3
      do end = 1, 2
        if (boundary%side(end, a)%mine) then
          call settle_side(records, speed, reference, boundary%side(end, a))
          boundary%open_across(a) = boundary%open_across(a) .or. any(boundary%side(end, a)%open)
        end if
      end do
      boundary%open_across(a) = boxes%comm%any_of(boundary%open_across(a))
    end do
    boundary%any_open = any(boundary%open_across)
  end subroutine settle_sides

  pure subroutine settle_side(records, speed, reference, side)
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: speed(:), reference
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
          side%flow = speed(m)
        end where
        if (.not. is_set(records(m)%pressure)) cycle
        where (record == m) side%pressure = records(m)%pressure
      end do
    end associate
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

  !> Give inflows that are not uniform their profile, with the mean over the faces of the region as it was.
  subroutine shape_inflow(boxes, mesh, records, area, boundary)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: area(:)  !< of the records [m2]
    type(gas_boundary_t), intent(inout) :: boundary

    real(wp) :: total(size(records))  !< of the profiles over their regions [m2]
    integer :: a, end, m

    if (.not. any([(records(m)%profile == 'parabola', m=1, size(records))])) return
    total = 0.0_wp
    do a = 1, 3
      do end = 1, 2
        if (boundary%side(end, a)%mine) call bend_flow(boxes, mesh, records, a, boundary%side(end, a), total)
      end do
    end do
    total = boxes%comm%sum(total)
    do m = 1, size(records)
      if (records(m)%profile /= 'parabola') cycle
      do a = 1, 3
        do end = 1, 2
          if (.not. boundary%side(end, a)%mine) cycle
          associate (side => boundary%side(end, a))
            where (side%record == m) side%flow = side%flow*area(m)/total(m)
          end associate
        end do
      end do
    end do
  end subroutine shape_inflow

  !> Multiply the flow of one side by s (1 - s) along each direction, s from edge to edge of the region, and add up these
  !> factors over my faces, rim left out.
  pure subroutine bend_flow(boxes, mesh, records, a, side, total)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: records(:)
    integer, intent(in) :: a
    type(side_t), intent(inout) :: side
    real(wp), intent(inout) :: total(:)

    integer :: i, j, k, m, rim(3)
    real(wp) :: share

    rim = 0
    rim(a) = lbound(side%record, a)
    do k = lbound(side%record, 3), ubound(side%record, 3)
      do j = lbound(side%record, 2), ubound(side%record, 2)
        do i = lbound(side%record, 1), ubound(side%record, 1)
          m = side%record(i, j, k)
          if (m == 0) cycle
          if (records(m)%profile /= 'parabola') cycle
          share = bow(mesh, records(m), face_centre(boxes, mesh, [i, j, k], a), a)
          side%flow(i, j, k) = share*side%flow(i, j, k)
          rim = [i, j, k]
          rim(a) = 1
          if (all(rim >= 1 .and. rim <= boxes%n)) total(m) = total(m) + share*side%area(i, j, k)
        end do
      end do
    end do
  end subroutine bend_flow

  !> The parabola at x on a region across `a`, of no scale.
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
      if (allocated(boundary%ramp(m)%times)) factor = factor_at(boundary%ramp(m), time)
      boundary%inflow = boundary%inflow + factor*boundary%nominal(m)
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

  !> Linear between the times of a table; of times that are equal the last counts.
  pure function factor_at(ramp, time) result(factor)
    type(ramp_t), intent(in) :: ramp
    real(wp), intent(in) :: time  !< [s]
    real(wp) :: factor

    integer :: below

    below = count(ramp%times <= time)
    if (below == 0) then
      factor = ramp%factors(1)
    else if (below == size(ramp%times)) then
      factor = ramp%factors(below)
    else
      associate (t => ramp%times(below:below + 1), f => ramp%factors(below:below + 1))
        factor = f(1) + (f(2) - f(1))*(time - t(1))/(t(2) - t(1))
      end associate
    end if
  end function factor_at

end module gas_boundary
