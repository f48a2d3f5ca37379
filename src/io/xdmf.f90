!> XDMF sidecars: the same data as a .vtkhdf file, described in XML for programs that do not know that format
!> (ParaView before 5.12; open with its reader "XDMF", not "Xdmf3").
module xdmf
  use files, only: rename_file
  use hdf5_file, only: single_kind, long_kind
  use kinds, only: wp, i8
  use mesh, only: mesh_t
  use outcome, only: outcome_t, exit_environment
  use vtkhdf_steps, only: field_t
  implicit none
  private
  public :: write_cloud_sidecar, write_grid_sidecar

contains

  !> The sidecar of a cloud of points.
  subroutine write_cloud_sidecar(name, fields, times, points, outcome)
    character(len=*), intent(in) :: name        !< of the .vtkhdf file
    type(field_t), intent(in) :: fields(:)
    real(wp), intent(in) :: times(:)            !< of the steps [s]
    integer(i8), intent(in) :: points(:)        !< of each step
    type(outcome_t), intent(inout) :: outcome

    integer :: unit, step, i
    integer(i8) :: first
    character(len=:), allocatable :: source

    source = base_of(name)
    call begin_sidecar(name, 'parcels', unit, outcome)
    if (outcome%failed()) return
    first = 0
    do step = 1, size(times)
      call begin_grid(unit, times(step))
      write (unit, '(a,i0,a)') '<Topology TopologyType="Polyvertex" NumberOfElements="', points(step), '"/>'
      write (unit, '(a)') '<Geometry GeometryType="XYZ">'
      call write_slab(unit, source//':/VTKHDF/Points', single_kind, [sum(points), 3_i8], [first, 0_i8], [points(step), 3_i8])
      write (unit, '(a)') '</Geometry>'
      do i = 1, size(fields)
        call begin_field(unit, fields(i), 'Node')
        associate (n => fields(i)%components, path => source//':/VTKHDF/PointData/'//trim(fields(i)%name))
          if (n == 1) call write_slab(unit, path, fields(i)%kind, [sum(points)], [first], [points(step)])
          if (n == 3) call write_slab(unit, path, fields(i)%kind, [sum(points), 3_i8], [first, 0_i8], [points(step), 3_i8])
        end associate
        write (unit, '(a)') '</Attribute>'
      end do
      write (unit, '(a)') '</Grid>'
      first = first + points(step)
    end do
    call end_sidecar(name, unit, outcome)
  end subroutine write_cloud_sidecar

  !> The sidecar of a grid of cells.
  subroutine write_grid_sidecar(name, fields, times, mesh, outcome)
    character(len=*), intent(in) :: name         !< of the .vtkhdf file
    type(field_t), intent(in) :: fields(:)
    real(wp), intent(in) :: times(:)             !< of the steps [s]
    type(mesh_t), intent(in) :: mesh
    type(outcome_t), intent(inout) :: outcome

    integer :: unit, step, i
    integer(i8) :: outer(4)
    character(len=:), allocatable :: source

    source = base_of(name)
    call begin_sidecar(name, 'gas', unit, outcome)
    if (outcome%failed()) return
    outer = [size(times), mesh%n(3), mesh%n(2), mesh%n(1)]   ! as C sees them
    do step = 1, size(times)
      call begin_grid(unit, times(step))
      call write_geometry(unit, mesh)
      do i = 1, size(fields)
        call begin_field(unit, fields(i), 'Cell')
        associate (path => source//':/VTKHDF/CellData/'//trim(fields(i)%name), start => [step - 1_i8, 0_i8, 0_i8, 0_i8])
          if (fields(i)%components == 1) then
            call write_slab(unit, path, fields(i)%kind, outer, start, [1_i8, outer(2:)])
          end if
          if (fields(i)%components == 3) then
            call write_slab(unit, path, fields(i)%kind, [outer, 3_i8], [start, 0_i8], [1_i8, outer(2:), 3_i8])
          end if
        end associate
        write (unit, '(a)') '</Attribute>'
      end do
      write (unit, '(a)') '</Grid>'
    end do
    call end_sidecar(name, unit, outcome)
  end subroutine write_grid_sidecar

  !> The corners of the cells.
  subroutine write_geometry(unit, mesh)
    integer, intent(in) :: unit
    type(mesh_t), intent(in) :: mesh

    integer :: a

    write (unit, '(3a,3(i0,1x),a)') '<Topology TopologyType="', trim(merge('3DCoRectMesh', '3DRectMesh  ', mesh%uniform)), &
      '" Dimensions="', mesh%n(3:1:-1) + 1, '"/>'
    if (mesh%uniform) then
      write (unit, '(a)') '<Geometry GeometryType="ORIGIN_DXDYDZ">'
      write (unit, '(a,3es24.16,a)') '<DataItem Dimensions="3" Format="XML">', mesh%lower(3:1:-1), '</DataItem>', &
        '<DataItem Dimensions="3" Format="XML">', mesh%finest(3:1:-1), '</DataItem>'
    else
      write (unit, '(a)') '<Geometry GeometryType="VXVYVZ">'
      do a = 1, 3
        write (unit, '(a,i0,a,*(es24.16))', advance='no') '<DataItem Dimensions="', mesh%n(a) + 1, '" Format="XML">', &
          mesh%axis(a)%face
        write (unit, '(a)') '</DataItem>'
      end do
    end if
    write (unit, '(a)') '</Geometry>'
  end subroutine write_geometry

  !> The file name without folders: the sidecar lies beside it.
  pure function base_of(name) result(base)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: base

    base = name(index(name, '/', back=.true.) + 1:)
  end function base_of

  pure function sidecar_of(name) result(sidecar)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: sidecar

    sidecar = name(:index(name, '.', back=.true.))//'xmf'
  end function sidecar_of

  subroutine begin_sidecar(name, what, unit, outcome)
    character(len=*), intent(in) :: name, what
    integer, intent(out) :: unit
    type(outcome_t), intent(inout) :: outcome

    integer :: status
    character(len=200) :: reason

    open (newunit=unit, file=sidecar_of(name)//'.tmp', action='write', status='replace', iostat=status, iomsg=reason)
    if (status /= 0) then
      call outcome%fail(exit_environment, "cannot write '"//sidecar_of(name)//"': "//trim(reason))
      return
    end if
    write (unit, '(a)') '<?xml version="1.0"?>', '<Xdmf Version="2.0"><Domain>', &
      '<Grid Name="'//what//'" GridType="Collection" CollectionType="Temporal">'
  end subroutine begin_sidecar

  !> The new sidecar takes the place of the old one at once.
  subroutine end_sidecar(name, unit, outcome)
    character(len=*), intent(in) :: name
    integer, intent(in) :: unit
    type(outcome_t), intent(inout) :: outcome

    integer :: status
    character(len=200) :: reason

    write (unit, '(a)') '</Grid>', '</Domain></Xdmf>'
    close (unit, iostat=status, iomsg=reason)
    if (status /= 0) call outcome%fail(exit_environment, "cannot write '"//sidecar_of(name)//"': "//trim(reason))
    if (status == 0) call rename_file(sidecar_of(name)//'.tmp', sidecar_of(name), outcome)
  end subroutine end_sidecar

  subroutine begin_grid(unit, time)
    integer, intent(in) :: unit
    real(wp), intent(in) :: time

    write (unit, '(a,es24.16,a)') '<Grid Name="step" GridType="Uniform"><Time Value="', time, '"/>'
  end subroutine begin_grid

  subroutine begin_field(unit, field, center)
    integer, intent(in) :: unit
    type(field_t), intent(in) :: field
    character(len=*), intent(in) :: center  !< 'Node' or 'Cell'

    write (unit, '(7a)') '<Attribute Name="', trim(field%name), '" Center="', center, '" AttributeType="', &
      trim(merge('Scalar', 'Vector', field%components == 1)), '">'
  end subroutine begin_field

  !> A piece of a dataset: where it starts, how many, all as C orders them, the slowest dimension first.
  subroutine write_slab(unit, path, kind, extent, start, count)
    integer, intent(in) :: unit, kind
    character(len=*), intent(in) :: path
    integer(i8), intent(in) :: extent(:), start(:), count(:)

    character(len=60) :: number
    character(len=120) :: dimensions

    number = '" NumberType="Int" Precision="4"'
    if (kind == single_kind) number = '" NumberType="Float" Precision="4"'
    if (kind == long_kind) number = '" NumberType="Int" Precision="8"'
    ! Of a grid, one of several steps is taken and its dimension vanishes.
    write (dimensions, '(*(i0,1x))') count(merge(2, 1, size(count) > 3):)
    write (unit, '(4a)') '<DataItem ItemType="HyperSlab" Type="HyperSlab" Dimensions="', trim(dimensions), trim(number), '>'
    write (unit, '(a,i0,a,*(i0,1x))', advance='no') '<DataItem Dimensions="3 ', size(count), '" Format="XML">', &
      start, 0*start + 1, count
    write (dimensions, '(*(i0,1x))') extent
    write (unit, '(7a)') '</DataItem>', '<DataItem Format="HDF" Dimensions="', trim(dimensions), trim(number), '>', path, &
      '</DataItem>'
    write (unit, '(a)') '</DataItem>'
  end subroutine write_slab

end module xdmf
