!> Everything a case file says.
module case
  use boundary_settings, only: boundary_settings_t, declare_boundary
  use case_keys, only: keys_t
  use contact_settings, only: contact_settings_t, declare_contact
  use coupling_settings, only: coupling_settings_t, declare_coupling
  use des_settings, only: des_settings_t, declare_des
  use domain_settings, only: domain_settings_t, declare_domain, declare_grid
  use gas_numerics, only: gas_numerics_t, declare_gas_numerics
  use gas_settings, only: gas_settings_t, declare_gas
  use material_settings, only: declare_material, declare_pair
  use monitor_settings, only: monitor_settings_t, declare_monitor
  use output_settings, only: output_settings_t, declare_output
  use parcels_settings, only: parcels_settings_t, fill_settings_t, declare_parcels, declare_fill
  use powder_settings, only: powder_settings_t, declare_powder
  use run_settings, only: run_settings_t, declare_run
  use surface, only: surface_t
  use table_settings, only: table_settings_t, declare_table
  use wall_settings, only: wall_settings_t, declare_wall
  implicit none
  private
  public :: case_t, declare_case

  type :: case_t
    character(len=:), allocatable :: file         !< where it was read from
    character(len=:), allocatable :: text         !< with all values in effect, defaults included, as a case file
    logical :: with_gas = .false.
    logical :: with_parcels = .false.
    type(run_settings_t) :: run
    type(domain_settings_t) :: domain             !< and grid
    type(gas_settings_t) :: gas
    type(gas_numerics_t) :: gas_numerics
    type(boundary_settings_t), allocatable :: boundaries(:)
    type(table_settings_t), allocatable :: tables(:)
    type(powder_settings_t), allocatable :: powders(:)
    type(parcels_settings_t) :: parcels
    type(fill_settings_t), allocatable :: fills(:)
    type(wall_settings_t), allocatable :: walls(:)
    type(surface_t), allocatable :: surfaces(:)   !< (walls) of those that are meshes
    type(contact_settings_t) :: contact
    type(des_settings_t) :: des
    type(coupling_settings_t) :: coupling
    type(output_settings_t) :: output
    type(monitor_settings_t), allocatable :: monitors(:)
  contains
    procedure :: wall_materials
  end type case_t

contains

  !> All groups, in the order in which they are listed.
  subroutine declare_case(case, keys)
    type(case_t), intent(inout) :: case
    type(keys_t), intent(inout) :: keys

    case%with_gas = keys%has_group('gas')
    case%with_parcels = keys%has_group('parcels') .or. keys%has_group('powder') .or. keys%has_group('fill') &
                        .or. keys%has_group('contact')
    call keys%group('run', 'what is computed, and for how long', 'always required', required=.true.)
    call declare_run(case%run, keys)
    call keys%group('domain', 'the box in which everything happens', 'always required', required=.true.)
    call declare_domain(case%domain, keys)
    call declare_gas_groups(case, keys)
    call declare_powder_groups(case, keys)
    call keys%group('coupling', 'what gas and parcels do to each other', 'optional, with &gas and &parcels', &
                    unwanted=.not. (case%with_gas .and. case%with_parcels))
    call declare_coupling(case%coupling, keys)
    call keys%group('numerics', 'steps and tolerances', 'optional')
    call declare_gas_numerics(case%gas_numerics, keys)
    call declare_des(case%des, keys)
    call declare_output_groups(case, keys)
    call keys%finish()
  end subroutine declare_case

  subroutine declare_gas_groups(case, keys)
    type(case_t), intent(inout) :: case
    type(keys_t), intent(inout) :: keys

    integer :: i

    call keys%group('gas', 'the gas', 'without it only parcels move', unwanted=.not. case%with_gas)
    call declare_gas(case%gas, keys)
    call keys%group('grid', 'the cells of the gas', 'required with &gas, and only used with it', &
                    required=case%with_gas, unwanted=.not. case%with_gas)
    call declare_grid(case%domain, keys)
    call keys%group('boundary', 'a region of the domain''s surface', 'optional; the rest of the surface is wall', &
                    repeated=.true.)
    allocate (case%boundaries(keys%number()))
    do i = 1, size(case%boundaries)
      call keys%open(i)
      call declare_boundary(case%boundaries(i), keys)
    end do
  end subroutine declare_gas_groups

  subroutine declare_powder_groups(case, keys)
    type(case_t), intent(inout) :: case
    type(keys_t), intent(inout) :: keys

    character(len=*), parameter :: when = 'required for parcels, and only used for them'
    integer :: i

    call keys%group('table', 'sizes and their shares of a powder', 'optional', repeated=.true.)
    allocate (case%tables(keys%number()))
    do i = 1, size(case%tables)
      call keys%open(i)
      call declare_table(case%tables(i), keys)
    end do
    call declare_materials(case, keys)
    call keys%group('powder', 'particles of one density and their sizes', when, required=case%with_parcels, repeated=.true.)
    allocate (case%powders(keys%number()))
    do i = 1, size(case%powders)
      call keys%open(i)
      call declare_powder(case%powders(i), case%tables, keys)
    end do
    call keys%group('parcels', 'how particles are put together into parcels', when, &
                    required=case%with_parcels, unwanted=.not. case%with_parcels)
    call declare_parcels(case%parcels, keys)
    call keys%group('fill', 'parcels at the start', when, required=case%with_parcels, repeated=.true.)
    allocate (case%fills(keys%number()))
    do i = 1, size(case%fills)
      call keys%open(i)
      call declare_fill(case%fills(i), keys)
    end do
    call keys%group('wall', 'a plane, cylinder, cone or mesh of triangles in the domain', &
                    'optional; the gas passes through it unless gas_side says otherwise', repeated=.true.)
    allocate (case%walls(keys%number()), case%surfaces(keys%number()))
    do i = 1, size(case%walls)
      call keys%open(i)
      call declare_wall(case%walls(i), keys)
    end do
    call keys%group('contact', 'springs, dashpots and friction', when, &
                    required=case%with_parcels, unwanted=.not. case%with_parcels)
    if (allocated(case%contact%materials)) then
      case%contact%powder_material = case%powders%material
      case%contact%own_material = [case%walls%material, case%boundaries%material]
    end if
    call declare_contact(case%contact, keys)
    where (case%walls%material == 0) case%walls%material = case%contact%wall_material
  end subroutine declare_powder_groups

  !> What powders and walls may be made of.
  subroutine declare_materials(case, keys)
    type(case_t), intent(inout) :: case
    type(keys_t), intent(inout) :: keys

    integer :: i

    call keys%group('material', 'what powders and walls may be made of', 'optional, with &parcels; what it does not say is as '// &
                    'in &contact', unwanted=.not. case%with_parcels, repeated=.true.)
    if (keys%number() > 0) allocate (case%contact%materials(keys%number()))
    do i = 1, keys%number()
      call keys%open(i)
      call declare_material(case%contact%materials(i), keys)
    end do
    call keys%group('material_pair', 'contacts between two materials', 'optional, with &material; what it does not say follows '// &
                    'from the two', unwanted=.not. case%with_parcels, repeated=.true.)
    allocate (case%contact%pairs(keys%number()))
    do i = 1, keys%number()
      call keys%open(i)
      call declare_pair(case%contact%pairs(i), case%contact%pairs(:i - 1), keys)
    end do
  end subroutine declare_materials

  subroutine declare_output_groups(case, keys)
    type(case_t), intent(inout) :: case
    type(keys_t), intent(inout) :: keys

    integer :: i

    call keys%group('output', 'where results go, and how often', 'optional')
    call declare_output(case%output, keys)
    call keys%group('monitor', 'a place and what is recorded there', 'optional', repeated=.true.)
    allocate (case%monitors(keys%number()))
    do i = 1, size(case%monitors)
      call keys%open(i)
      call declare_monitor(case%monitors(i), keys)
    end do
  end subroutine declare_output_groups

  !> What faces and walls are made of, as far as is known: see contact_pairs.
  pure function wall_materials(self) result(materials)
    class(case_t), intent(in) :: self
    integer, allocatable :: materials(:)

    materials = [self%contact%wall_material, self%walls%material, &
                 pack(self%boundaries%material, self%boundaries%material > 0)]
  end function wall_materials

end module case
