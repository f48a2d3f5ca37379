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
  use outcome, only: outcome_t, exit_input
  implicit none
  private
  public :: gas_boundary_t, new_gas_boundary

  real(wp), parameter :: closeness = 1.0e-6_wp  !< of a cell's edge: what counts as lying on a plane

  !> The faces of my box on one side of the domain. All arrays have the shape of the side as seen from the velocity
  !> across it: (x,y,z) indices of the faces, one thick across, 0..n+1 along the side; the rims repeat or wrap.
  type :: side_t
    logical :: mine = .false.                     !< my box touches this side of the domain
    logical, allocatable :: open(:,:,:)           !< outflow: the pressure is given, the velocity is solved for
    real(wp), allocatable :: grip(:,:,:)          !< 1 where the velocity along the face is zero on it, 0 where it slips
    real(wp), allocatable :: flow(:,:,:)          !< superficial velocity into the domain [m/s]
    real(wp), allocatable :: pressure(:,:,:)      !< on open faces [Pa]
    integer, allocatable, private :: record(:,:,:)
  end type side_t

  type :: gas_boundary_t
    type(side_t) :: side(2, 3)      !< (low or high, direction)
    logical :: any_open = .false.   !< some face of the domain is open
    logical :: open_across(3) = .false.  !< some face across this direction is open
    real(wp) :: inflow = 0.0_wp     !< volume flow into the domain through all inflow faces [m3/s]
  end type gas_boundary_t

contains

  !> Resolve the records on the surface of my box; mistakes that only the grid shows go into `outcome`.
  subroutine new_gas_boundary(boxes, mesh, records, settings, boundary, outcome)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: records(:)
    type(gas_settings_t), intent(in) :: settings
    type(gas_boundary_t), intent(out) :: boundary
    type(outcome_t), intent(inout) :: outcome

    real(wp) :: area(size(records)), speed(size(records))
    integer :: a, end, overlap

    area = 0.0_wp
    overlap = 0
    do a = 1, 3
      do end = 1, 2
        call name_faces(boxes, mesh, records, a, end, boundary%side(end, a), overlap)
        if (boundary%side(end, a)%mine) call add_area(boundary%side(end, a), boxes%n, a, mesh%area(a), area)
      end do
    end do
    area = boxes%comm%sum(area)
    call check_records(records, area, boxes%comm%max(overlap), outcome)
    speed = superficial(records, area, settings%density)
    boundary%inflow = sum(speed*area)
    call settle_sides(boxes, records, speed, settings%pressure, boundary)
    if (boundary%inflow > 0.0_wp .and. .not. boundary%any_open) then
      call outcome%fail(exit_input, 'gas flows in but no &boundary is an outflow: an incompressible gas needs one')
    end if
  end subroutine new_gas_boundary

  !> Which record owns each face of one side, 0 for none. The last of several wins, after `overlap` has told of them.
  pure subroutine name_faces(boxes, mesh, records, a, end, side, overlap)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(boundary_settings_t), intent(in) :: records(:)
    integer, intent(in) :: a, end
    type(side_t), intent(inout) :: side
    integer, intent(inout) :: overlap  !< which two records hold one face: first + (second - 1)*size(records)

    integer :: i, j, k, m, lo(3), hi(3)
    real(wp) :: x(3)

    side%mine = merge(boxes%at_low(a), boxes%at_high(a), end == 1)
    if (.not. side%mine) return
    call side_bounds(boxes, a, end, lo, hi)
    allocate (side%record(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)), source=0)
    do k = lo(3), hi(3)
      do j = lo(2), hi(2)
        do i = lo(1), hi(1)
          x = face_centre(boxes, mesh, [i, j, k], a)
          do m = 1, size(records)
            if (.not. holds(records(m), x, mesh%h)) cycle
            if (side%record(i, j, k) /= 0) overlap = side%record(i, j, k) + (m - 1)*size(records)
            side%record(i, j, k) = m
          end do
        end do
      end do
    end do
  end subroutine name_faces

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
    x = mesh%lower + (place - 0.5_wp)*mesh%h
    x(a) = mesh%lower(a) + place(a)*mesh%h(a)
  end function face_centre

  pure function holds(record, x, h)
    type(boundary_settings_t), intent(in) :: record
    real(wp), intent(in) :: x(3), h(3)
    logical :: holds

    holds = all(x >= record%lower - closeness*h .and. x <= record%upper + closeness*h)
  end function holds

  !> Add the areas of my faces, rim left out, to those of their records.
  pure subroutine add_area(side, n, a, face, area)
    type(side_t), intent(in) :: side
    integer, intent(in) :: n(3), a
    real(wp), intent(in) :: face  !< area of one face [m2]
    real(wp), intent(inout) :: area(:)

    integer :: m, lo(3), hi(3)

    lo = 1
    hi = n
    lo(a) = lbound(side%record, a)
    hi(a) = lo(a)
    do m = 1, size(area)
      area(m) = area(m) + face*count(side%record(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)) == m)
    end do
  end subroutine add_area

  !> Mistakes that only the grid shows. All ranks find the same.
  pure subroutine check_records(records, area, overlap, outcome)
    type(boundary_settings_t), intent(in) :: records(:)
    real(wp), intent(in) :: area(:)
    integer, intent(in) :: overlap
    type(outcome_t), intent(inout) :: outcome

    integer :: m

    do m = 1, size(records)
      if (area(m) > 0.0_wp) cycle
      call outcome%fail(exit_input, '&boundary '//trim(records(m)%id)//' holds the centre of no cell face on the ' &
                        //'surface of the domain: move its corners onto a face that is not periodic, or widen it')
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
      if (records(m)%kind /= 'inflow') cycle
      if (is_set(records(m)%velocity)) then
        speed(m) = records(m)%velocity
      else if (area(m) > 0.0_wp) then
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
  end subroutine settle_side

end module gas_boundary
